//! How well a phrase fits a cluster.

use crate::models::dot;

/// A phrase against the background, for one cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// The phrase's share in the softmax, 0–1.
    pub share: f32,
    /// ln(share / (1 − share)): orders clusters where the share itself is rounded to 1.
    pub log_odds: f64,
    /// Cosine of the phrase and the cluster.
    pub cosine: f32,
}

/// The phrase's share in the softmax of `logit_scale` × cosine over itself and the background texts.
/// All features have unit length.
#[must_use]
pub fn score(cluster: &[f32], phrase: &[f32], background: &[Vec<f32>], logit_scale: f32) -> Score {
    let cosine = dot(cluster, phrase);
    let logit = |cosine: f32| f64::from(logit_scale) * f64::from(cosine);
    let logits: Vec<f64> = background.iter().map(|text| logit(dot(cluster, text))).collect();
    let highest = logits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if highest == f64::NEG_INFINITY {
        return Score { share: 1.0, log_odds: logit(cosine), cosine };
    }
    let sum: f64 = logits.iter().map(|logit| (logit - highest).exp()).sum();
    let log_odds = logit(cosine) - (highest + sum.ln());
    Score { share: (1.0 / (1.0 + (-log_odds).exp())) as f32, log_odds, cosine }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_the_softmax() {
        let cluster = [1.0, 0.0];
        let background = vec![vec![0.0, 1.0], vec![0.6, 0.8]];
        let found = score(&cluster, &[0.8, 0.6], &background, 5.0);
        let exponentials = [0.8, 0.0, 0.6].map(|cosine: f64| (5.0 * cosine).exp());
        let expected = exponentials[0] / exponentials.iter().sum::<f64>();
        // Cosines are single precision: 5 · 2⁻²⁴ in the logit.
        assert!((f64::from(found.share) - expected).abs() < 1e-6, "{found:?} {expected}");
        assert_eq!(found.cosine, 0.8);
    }

    #[test]
    fn scales_at_which_exponentials_overflow_still_order() {
        let background = vec![vec![-1.0, 0.0]];
        let near = score(&[1.0, 0.0], &[1.0, 0.0], &background, 1e4);
        let nearer = score(&[1.0, 0.0], &[0.9, 0.1], &background, 1e4);
        assert_eq!((near.share, nearer.share), (1.0, 1.0));
        assert!(near.log_odds > nearer.log_odds && near.log_odds.is_finite());
    }
}
