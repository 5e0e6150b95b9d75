//! Temperature of a joint from its friction.

use tribo_friction::thermal::ThermalJoint;

use super::ThermalSettingsError;

/// Longest window N, in samples.
pub const MAX_WINDOW: usize = 64;
/// Temperatures that are accepted (°C): no gearbox works outside.
const RANGE_C: [f64; 2] = [-60.0, 180.0];
/// The rise above the room (K) of which the uncertain heat is a part is at least this.
const LEAST_RISE_K: f64 = 5.0;

/// How far one innovation moves the temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObserverGain {
    /// η [K/(Nm s)] of simoni2019 (26), G of simoni2017 (10): constant.
    Fixed(f64),
    /// The gain of least variance for the stated errors: large while the temperature is unknown, small afterwards.
    Kalman,
}

/// Settings of [`TemperatureObserver`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverSettings {
    /// N: samples in an RMS value, 1 to 64.
    pub window: usize,
    /// η or Kalman.
    pub gain: ObserverGain,
    /// Standard deviation of the temperature at the start (K).
    pub initial_sd_k: f64,
    /// Error of the friction law as a part of the friction [-].
    pub model_error: f64,
    /// Further error of the friction (Nm), as by position and load.
    pub friction_sd_nm: f64,
    /// Time after which those errors are others (s): about that of a stroke.
    pub error_memory_s: f64,
    /// Error of the heat that is put in, as a part of the temperature rise it makes [-].
    pub heat_error: f64,
}

impl Default for ObserverSettings {
    /// N = 40 of simoni2019; a start in doubt by 10 K, a law that is right to 3 % and 0.05 Nm, heat to 20 %.
    fn default() -> Self {
        Self {
            window: 40,
            gain: ObserverGain::Kalman,
            initial_sd_k: 10.0,
            model_error: 0.03,
            friction_sd_nm: 0.05,
            error_memory_s: 2.0,
            heat_error: 0.2,
        }
    }
}

impl ObserverSettings {
    pub(super) fn validate(&self) -> Result<(), ThermalSettingsError> {
        let check = ThermalSettingsError::check;
        let window = self.window as f64;
        check("observer.window", window, (1..=MAX_WINDOW).contains(&self.window), "1 to 64")?;
        if let ObserverGain::Fixed(eta) = self.gain {
            check("observer.gain", eta, (0.0..=1e6).contains(&eta), "0 to 1e6 K/(Nm s)")?;
        }
        for (field, value) in [
            ("observer.initial_sd_k", self.initial_sd_k),
            ("observer.model_error", self.model_error),
            ("observer.friction_sd_nm", self.friction_sd_nm),
            ("observer.heat_error", self.heat_error),
        ] {
            check(field, value, (0.0..=1e3).contains(&value), "0 to 1e3")?;
        }
        let memory = self.error_memory_s;
        check("observer.error_memory_s", memory, memory > 0.0 && memory <= 1e4, "above 0, up to 1e4 s")
    }
}

/// Friction of one moment, measured and predicted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionSample {
    /// Measured friction (Nm): torque less what the rigid model explains.
    pub measured_nm: f64,
    /// Predicted friction (Nm) at the present temperature.
    pub predicted_nm: f64,
    /// Its derivative by the temperature [Nm/K].
    pub slope_nm_per_k: f64,
    /// Variance of the noise of the measured one (Nm²); it makes an RMS value too large and is taken off.
    pub noise_variance_nm2: f64,
}

/// What a correction saw and did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// tau_f,RMS − tau_f,RMS_hat (Nm).
    pub innovation_nm: f64,
    /// Its standard deviation (Nm), temperature included.
    pub sd_nm: f64,
    /// Change of the temperature (K).
    pub step_k: f64,
}

/// RMS temperature observer of one joint (simoni2017 (8), (10); simoni2019 (26)):
///
/// ```text
/// T̂⁺ = T̂ + [q̇ tau_f_hat − K (T̂ − T_env)] t_s/C − η (tau_f,RMS − tau_f,RMS_hat) t_s
/// P⁺ = (1 − L H)² P + L² R,   H = ∂tau_f,RMS_hat/∂T,   L = −η t_s or P H/(H² P + R)
/// ```
///
/// RMS values are over the last N samples that were offered; what is offered is the caller's choice: sliding, and free of
/// contact. [`Self::warm`] is the first bracket, [`Self::correct`] the rest.
///
/// | what the papers say | what we do | why |
/// |---|---|---|
/// | −η, which presumes that warmth takes friction away | the sign of H | a joint in its Stribeck range gains friction by warmth, and −η would run away |
/// | tau_f,RMS_hat of past temperatures | past samples at the present temperature | the law is linear in T, so it costs nothing and a high gain does not swing |
/// | RMS with its noise | noise variance taken off | √(tau² + σ²) > tau reads as a joint that is too cold |
/// | one η for all time | also a Kalman gain, and P in either case | the wrench needs to know how sure the temperature is |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureObserver {
    joint: ThermalJoint,
    settings: ObserverSettings,
    temperature_c: f64,
    variance_k2: f64,
    measured: [f64; MAX_WINDOW],
    /// Predicted friction less slope times temperature, slope, and variance of the noise.
    offset: [f64; MAX_WINDOW],
    slope: [f64; MAX_WINDOW],
    noise: [f64; MAX_WINDOW],
    next: usize,
    filled: usize,
}

impl TemperatureObserver {
    /// An observer that starts at `temperature_c` (°C).
    ///
    /// # Errors
    /// The first setting outside its range.
    pub fn new(
        joint: ThermalJoint,
        settings: ObserverSettings,
        temperature_c: f64,
    ) -> Result<Self, ThermalSettingsError> {
        settings.validate()?;
        let in_range = (RANGE_C[0]..=RANGE_C[1]).contains(&temperature_c);
        ThermalSettingsError::check("initial_c", temperature_c, in_range, "-60 to 180 °C")?;
        let none = [0.0; MAX_WINDOW];
        let mut observer = Self {
            joint,
            settings,
            temperature_c,
            variance_k2: 0.0,
            measured: none,
            offset: none,
            slope: none,
            noise: none,
            next: 0,
            filled: 0,
        };
        observer.restart(temperature_c);
        Ok(observer)
    }

    /// Forgets everything but the settings; starts at `temperature_c` (°C).
    pub fn restart(&mut self, temperature_c: f64) {
        self.temperature_c = temperature_c.clamp(RANGE_C[0], RANGE_C[1]);
        self.variance_k2 = self.settings.initial_sd_k.powi(2);
        self.forget_window();
    }

    /// Forgets the samples of the window: those before a contact was noticed may have had some of it.
    #[inline]
    pub fn forget_window(&mut self) {
        (self.next, self.filled) = (0, 0);
    }

    /// The joint.
    pub fn joint(&self) -> &ThermalJoint {
        &self.joint
    }

    /// T̂ (°C).
    #[inline]
    pub fn temperature_c(&self) -> f64 {
        self.temperature_c
    }

    /// P (K²).
    #[inline]
    pub fn variance_k2(&self) -> f64 {
        self.variance_k2
    }

    /// `dt_s` (s) of mean friction power `power_w` (W) in a room of `ambient_c` (°C).
    ///
    /// Old doubt fades with the joint's time constant at rest, new doubt of the heat comes up to
    /// `heat_error · (T̂ − T_env)`.
    #[inline]
    pub fn warm(&mut self, power_w: f64, ambient_c: f64, dt_s: f64) {
        let heat = self.joint.heat();
        let next = heat.step(self.temperature_c, power_w.max(0.0), ambient_c, dt_s);
        if !next.is_finite() {
            return;
        }
        let share = -(-2.0 * dt_s / heat.rest_time_constant_s()).exp_m1();
        let doubt = self.settings.heat_error * (next - ambient_c).abs().max(LEAST_RISE_K);
        self.variance_k2 += share * (doubt * doubt - self.variance_k2);
        self.temperature_c = next.clamp(RANGE_C[0], RANGE_C[1]);
    }

    /// Takes a sample into the window and moves the temperature; `dt_s` (s) since the sample before.
    ///
    /// None while the window fills, where warmth does not change friction, and for numbers that are not finite.
    #[inline]
    pub fn correct(&mut self, sample: &FrictionSample, dt_s: f64) -> Option<Innovation> {
        let FrictionSample { measured_nm, predicted_nm, slope_nm_per_k, noise_variance_nm2 } = *sample;
        if ![measured_nm, predicted_nm, slope_nm_per_k, noise_variance_nm2].iter().all(|x| x.is_finite()) {
            return None;
        }
        let (s, at) = (&self.settings, self.next);
        self.measured[at] = measured_nm;
        self.offset[at] = predicted_nm - slope_nm_per_k * self.temperature_c;
        self.slope[at] = slope_nm_per_k;
        self.noise[at] = noise_variance_nm2;
        self.next = (at + 1) % s.window;
        self.filled = (self.filled + 1).min(s.window);
        if self.filled < s.window {
            return None;
        }
        let (mut measured, mut predicted, mut product, mut noise) = (0.0, 0.0, 0.0, 0.0);
        for k in 0..s.window {
            let tau = self.offset[k] + self.slope[k] * self.temperature_c;
            measured += self.measured[k] * self.measured[k];
            predicted += tau * tau;
            product += tau * self.slope[k];
            noise += self.noise[k];
        }
        let count = s.window as f64;
        let noise = noise / count;
        let measured_rms = (measured / count - noise).max(0.0).sqrt();
        let predicted_rms = (predicted / count).sqrt();
        let h = product / count / predicted_rms;
        if !(h.is_finite() && h != 0.0) {
            return None;
        }
        let error = (s.model_error * predicted_rms).powi(2) + s.friction_sd_nm.powi(2);
        // Errors last for many samples: each is worth the less.
        let r = error * (s.error_memory_s / dt_s).max(1.0) + noise;
        let gain = match s.gain {
            ObserverGain::Fixed(eta) => eta * dt_s * h.signum(),
            ObserverGain::Kalman => self.variance_k2 * h / (h * h * self.variance_k2 + r),
        };
        let innovation_nm = measured_rms - predicted_rms;
        let step_k = gain * innovation_nm;
        let variance = (1.0 - gain * h).powi(2) * self.variance_k2 + gain * gain * r;
        if !(step_k.is_finite() && variance.is_finite()) {
            return None;
        }
        let sd_nm = (h * h * self.variance_k2 + error + noise / count).sqrt();
        self.temperature_c = (self.temperature_c + step_k).clamp(RANGE_C[0], RANGE_C[1]);
        self.variance_k2 = variance;
        Some(Innovation { innovation_nm, sd_nm, step_k })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_friction::thermal::{HeatBalance, PolynomialStribeck, TemperatureFactor, ThermalLaw};

    fn joint(alpha: f64) -> ThermalJoint {
        let cold = PolynomialStribeck { polynomial: [80.0, 60.0, 0.0, 0.0], ..PolynomialStribeck::default() };
        let polynomial = TemperatureFactor { slope_per_k: alpha, level: 1.0 };
        let law = ThermalLaw { polynomial, ..ThermalLaw::without_temperature(cold.into()) };
        ThermalJoint::new(law, HeatBalance::SIMONI2019).unwrap()
    }

    fn fixed(eta: f64, window: usize) -> ObserverSettings {
        ObserverSettings { gain: ObserverGain::Fixed(eta), window, ..ObserverSettings::default() }
    }

    /// Offers friction at `true_c` and constant speed for `seconds`; returns the error after each sample.
    fn run(observer: &mut TemperatureObserver, true_c: f64, seconds: f64) -> Vec<f64> {
        let (law, dt) = (*observer.joint().law(), 0.02);
        (0..(seconds / dt) as usize)
            .map(|k| {
                let qd = if k % 100 < 50 { 0.8 } else { -0.8 };
                let t = observer.temperature_c();
                observer.correct(
                    &FrictionSample {
                        measured_nm: law.torque_nm(qd, true_c),
                        predicted_nm: law.torque_nm(qd, t),
                        slope_nm_per_k: law.slope_nm_per_k(qd, t),
                        noise_variance_nm2: 0.0,
                    },
                    dt,
                );
                observer.temperature_c() - true_c
            })
            .collect()
    }

    /// Closed form: without heat, (26) is ė = −η |∂tau/∂T| e, in either sign of the dependence.
    #[test]
    fn a_wrong_start_decays_at_the_rate_of_the_gain() {
        for (alpha, eta) in [(-0.00937, 5e-3), (-0.00937, 5e-2), (0.00937, 5e-2)] {
            let mut observer = TemperatureObserver::new(joint(alpha), fixed(eta, 20), 22.0).unwrap();
            let errors = run(&mut observer, 32.0, 20.0);
            let rate = eta * 0.00937 * (80.0 + 60.0 * 0.8);
            // The window fills during the first 19 samples.
            let expected = -10.0 * (-rate * (20.0 - 19.0 * 0.02)).exp();
            let last = errors[errors.len() - 1];
            assert!((last - expected).abs() < 0.02, "{alpha} {eta}: {last} for {expected}");
        }
    }

    /// The Kalman gain is the mean of a prior and n measurements: the closed form of a constant seen n times.
    #[test]
    fn kalman_is_the_weighted_mean() {
        let settings = ObserverSettings { window: 1, ..ObserverSettings::default() };
        let mut observer = TemperatureObserver::new(joint(-0.00937), settings, 22.0).unwrap();
        let errors = run(&mut observer, 32.0, 4.0);
        let h = 0.00937 * 128.0;
        let predicted: f64 = 128.0 * (1.0 - 0.00937 * 10.0);
        let r = ((0.03 * predicted).powi(2) + 0.05_f64.powi(2)) * 100.0;
        let n = errors.len() as f64;
        let expected = 1.0 / (1.0 / 100.0 + n * h * h / r);
        assert!((observer.variance_k2() / expected - 1.0).abs() < 0.03, "{} {expected}", observer.variance_k2());
        let last = errors[errors.len() - 1];
        assert!((last / (-10.0 * expected / 100.0) - 1.0).abs() < 0.1, "{last}");
    }

    /// Noise makes an RMS value larger; with the noise variance taken off the mean is right.
    #[test]
    fn noise_is_taken_off() {
        let mut biased = [0.0; 2];
        for (i, noise_off) in [0.0, 400.0].into_iter().enumerate() {
            let mut observer = TemperatureObserver::new(joint(-0.00937), fixed(0.01, 64), 32.0).unwrap();
            let law = *observer.joint().law();
            let mut mean = 0.0;
            for k in 0..20_000_u32 {
                // ±20 Nm, uncorrelated with the friction: variance 400.
                let noise = if (k.wrapping_mul(2_654_435_761) >> 16) & 1 == 0 { 20.0 } else { -20.0 };
                let (qd, t) = (0.8, observer.temperature_c());
                let sample = FrictionSample {
                    measured_nm: law.torque_nm(qd, 32.0) + noise,
                    predicted_nm: law.torque_nm(qd, t),
                    slope_nm_per_k: law.slope_nm_per_k(qd, t),
                    noise_variance_nm2: noise_off,
                };
                observer.correct(&sample, 0.02);
                mean += if k >= 10_000 { (observer.temperature_c() - 32.0) / 10_000.0 } else { 0.0 };
            }
            biased[i] = mean;
        }
        // √(116² + 20²) − 116 = 1.71 Nm, or 1.4 K.
        assert!((biased[0] + 1.43).abs() < 0.15 && biased[1].abs() < 0.15, "{biased:?}");
    }

    /// A rest: doubt of the start fades with C/K, doubt of the heat comes.
    #[test]
    fn doubt_of_the_start_fades_at_rest() {
        let mut observer = TemperatureObserver::new(joint(-0.00937), ObserverSettings::default(), 52.0).unwrap();
        let tau = HeatBalance::SIMONI2019.rest_time_constant_s();
        for _ in 0..1000 {
            observer.warm(0.0, 22.0, tau * 1e-3);
        }
        assert!((observer.temperature_c() - (22.0 + 30.0 * (-1.0_f64).exp())).abs() < 1e-9);
        let variance = observer.variance_k2();
        assert!(variance < 100.0 * (-2.0_f64).exp() + 16.0 && variance > 100.0 * (-2.0_f64).exp(), "{variance}");
    }

    #[test]
    fn bad_numbers_change_nothing_and_bad_settings_are_named() {
        let mut observer = TemperatureObserver::new(joint(-0.00937), fixed(0.05, 2), 25.0).unwrap();
        let before = observer;
        let bad = FrictionSample { measured_nm: f64::NAN, predicted_nm: 1.0, ..FrictionSample::default() };
        assert_eq!((observer.correct(&bad, 0.01), observer), (None, before));
        for (settings, field) in [
            (ObserverSettings { window: 0, ..fixed(1.0, 1) }, "observer.window"),
            (ObserverSettings { window: 65, ..fixed(1.0, 1) }, "observer.window"),
            (fixed(-1.0, 5), "observer.gain"),
            (ObserverSettings { error_memory_s: 0.0, ..fixed(1.0, 1) }, "observer.error_memory_s"),
        ] {
            assert_eq!(TemperatureObserver::new(joint(0.0), settings, 25.0).unwrap_err().field, field);
        }
        assert_eq!(TemperatureObserver::new(joint(0.0), fixed(1.0, 1), f64::NAN).unwrap_err().field, "initial_c");
    }
}
