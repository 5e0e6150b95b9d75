//! The 1 kHz tick and its record
