//! Work that takes longer than a frame.

use std::sync::mpsc::{Receiver, Sender, channel};

use crate::snapshot::Answer;

/// Runs work in threads, or at once where every frame must be the same: tests and screenshots.
#[derive(Debug)]
pub struct Jobs {
    immediate: bool,
    sender: Sender<Answer>,
    receiver: Receiver<Answer>,
    running: usize,
}

impl Jobs {
    /// No work yet.
    pub fn new(immediate: bool) -> Self {
        let (sender, receiver) = channel();
        Self { immediate, sender, receiver, running: 0 }
    }

    /// Starts some work; `ctx` is woken when it is done.
    pub fn start(&mut self, ctx: &egui::Context, work: impl FnOnce() -> Answer + Send + 'static) {
        self.running += 1;
        if self.immediate {
            // The receiver is our own.
            let _ = self.sender.send(work());
            return;
        }
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        std::thread::spawn(move || {
            // A window that is gone does not mind.
            let _ = sender.send(work());
            ctx.request_repaint();
        });
    }

    /// What has been done since the last call.
    pub fn finished(&mut self) -> Vec<Answer> {
        let done: Vec<Answer> = self.receiver.try_iter().collect();
        self.running = self.running.saturating_sub(done.len());
        done
    }

    /// Whether something is being worked on.
    pub fn busy(&self) -> bool {
        self.running > 0
    }
}
