//! Trials, cost, strategies, campaigns
