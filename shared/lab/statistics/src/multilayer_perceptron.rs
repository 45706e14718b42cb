//! Multilayer perceptron with one hidden layer of rectified linear units for two classes, trained
//! by stochastic gradient descent with Adam (Kingma and Ba 2015).

use crate::labelled_rows::LabelledRows;
use random::Random;
use std::f32::consts::PI;
use std::f64::consts::TAU;

/// Settings of the training.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerceptronConfig {
    /// Number of hidden units.
    pub n_hidden: usize,
    /// Number of passes over the examples.
    pub n_epochs: usize,
    /// Number of examples of a step.
    pub batch: usize,
    /// Learning rate of the first step; it falls to zero along half a cosine.
    pub learning_rate: f32,
    /// Seed of the first weights and of the order of the examples.
    pub seed: u64,
}

/// Number of products that are summed side by side (SIMD).
const N_LANES: usize = 8;

/// Linear unit: a bias and a weight for each input.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearUnit {
    /// Value for inputs of zero.
    pub bias: f32,
    /// Weight of each input.
    pub weights: Vec<f32>,
}

/// Perceptron that predicts log odds.
#[derive(Debug, Clone, PartialEq)]
pub struct Perceptron {
    /// Hidden units over the features; negative values count as zero.
    pub hidden: Vec<LinearUnit>,
    /// Log odds over the hidden units.
    pub output: LinearUnit,
}

impl LinearUnit {
    /// Unit with weights drawn after He et al. (2015).
    fn random(n_inputs: usize, random: &mut Random) -> Self {
        let sigma = (2.0 / n_inputs as f64).sqrt();
        Self {
            bias: 0.0,
            weights: (0..n_inputs)
                .map(|_| (sigma * normal(random)) as f32)
                .collect(),
        }
    }

    fn zero(n_inputs: usize) -> Self {
        Self {
            bias: 0.0,
            weights: vec![0.0; n_inputs],
        }
    }

    /// Bias plus dot product, summed in lanes for vector instructions.
    fn value(&self, inputs: &[f32]) -> f32 {
        let mut lanes = [0.0; N_LANES];
        let (weights, rest) = self.weights.as_chunks::<N_LANES>();
        let (blocks, _) = inputs[..self.weights.len()].as_chunks::<N_LANES>();
        for (weights, inputs) in weights.iter().zip(blocks) {
            for (lane, (weight, x)) in lanes.iter_mut().zip(weights.iter().zip(inputs)) {
                *lane += weight * x;
            }
        }
        let last = rest.iter().zip(&inputs[self.weights.len() - rest.len()..]);
        self.bias + lanes.iter().sum::<f32>() + last.map(|(w, x)| w * x).sum::<f32>()
    }

    /// Add `scale` times the gradient of the unit's value.
    fn add_gradient(&mut self, inputs: &[f32], scale: f32) {
        self.bias += scale;
        for (weight, x) in self.weights.iter_mut().zip(inputs) {
            *weight += scale * x;
        }
    }

    fn parameters(&mut self) -> impl Iterator<Item = &mut f32> {
        std::iter::once(&mut self.bias).chain(&mut self.weights)
    }
}

impl Perceptron {
    /// Train on examples by the logistic loss; `after_epoch` is called after each pass over them.
    ///
    /// The features are standardised for the training; the weights that are returned apply to the
    /// features as they are.
    ///
    /// # Panics
    /// When the number of features is not that of the rows times the number of labels.
    pub fn train(
        examples: &LabelledRows<'_>,
        config: &PerceptronConfig,
        mut after_epoch: impl FnMut(),
    ) -> Self {
        let (n, n_features) = (examples.labels.len(), examples.n_features);
        assert_eq!(examples.features.len(), n * n_features);
        let standard = Standardisation::of(examples);
        let rows = standard.apply(examples.features);
        let mut random = Random::from_seed(config.seed);
        let mut model = Self::random(n_features, config.n_hidden, &mut random);
        let mut adam = Adam::default();
        let mut gradient = Gradient::of(&model);
        let mut order: Vec<usize> = (0..n).collect();
        let n_steps = n.div_ceil(config.batch) * config.n_epochs;
        for epoch in 0..config.n_epochs {
            random.shuffle(&mut order);
            for (i, batch) in order.chunks(config.batch).enumerate() {
                gradient.clear();
                for &row in batch {
                    let inputs = &rows[row * n_features..(row + 1) * n_features];
                    gradient.add(&model, inputs, examples.labels[row]);
                }
                let step = epoch * n.div_ceil(config.batch) + i;
                let phase = PI * step as f32 / n_steps as f32;
                let rate = 0.5 * config.learning_rate * (1.0 + phase.cos());
                adam.step(&mut model, &mut gradient, rate, batch.len());
            }
            after_epoch();
        }
        standard.fold_into(&mut model);
        model
    }

    /// Log odds of a row of features.
    pub fn log_odds(&self, features: &[f32]) -> f32 {
        let units = self.hidden.iter().map(|unit| unit.value(features).max(0.0));
        let products = units.zip(&self.output.weights).map(|(unit, w)| unit * w);
        self.output.bias + products.sum::<f32>()
    }

    fn random(n_features: usize, n_hidden: usize, random: &mut Random) -> Self {
        Self {
            hidden: (0..n_hidden)
                .map(|_| LinearUnit::random(n_features, random))
                .collect(),
            output: LinearUnit::random(n_hidden, random),
        }
    }

    fn parameters(&mut self) -> impl Iterator<Item = &mut f32> {
        let hidden = self.hidden.iter_mut().flat_map(LinearUnit::parameters);
        hidden.chain(self.output.parameters())
    }
}

/// Gradient of the logistic loss, summed over examples.
struct Gradient {
    of_weights: Perceptron,
    /// Values of the hidden units of one example.
    units: Vec<f32>,
}

impl Gradient {
    fn of(model: &Perceptron) -> Self {
        let zeros = |unit: &LinearUnit| LinearUnit::zero(unit.weights.len());
        Self {
            of_weights: Perceptron {
                hidden: model.hidden.iter().map(zeros).collect(),
                output: zeros(&model.output),
            },
            units: vec![0.0; model.hidden.len()],
        }
    }

    fn clear(&mut self) {
        self.of_weights.parameters().for_each(|value| *value = 0.0);
    }

    /// Add the gradient of one example.
    fn add(&mut self, model: &Perceptron, inputs: &[f32], label: bool) {
        for (value, unit) in self.units.iter_mut().zip(&model.hidden) {
            *value = unit.value(inputs).max(0.0);
        }
        let log_odds = model.output.value(&self.units);
        let error = 1.0 / (1.0 + (-log_odds).exp()) - f32::from(u8::from(label));
        self.of_weights.output.add_gradient(&self.units, error);
        let units = self.units.iter().zip(&model.output.weights);
        for (gradient, (value, weight)) in self.of_weights.hidden.iter_mut().zip(units) {
            if *value > 0.0 {
                gradient.add_gradient(inputs, error * weight);
            }
        }
    }
}

/// First and second moments of the gradient (Kingma and Ba 2015).
#[derive(Default)]
struct Adam {
    moments: Vec<[f32; 2]>,
    n_steps: i32,
}

impl Adam {
    /// Decay of the first and of the second moment.
    const DECAY: [f32; 2] = [0.9, 0.999];

    /// Step along the mean of a gradient over `n` examples.
    fn step(&mut self, model: &mut Perceptron, gradient: &mut Gradient, rate: f32, n: usize) {
        self.n_steps += 1;
        let n_weights = model.parameters().count();
        self.moments.resize(n_weights, [0.0; 2]);
        let unbiased = Self::DECAY.map(|decay| 1.0 / (1.0 - decay.powi(self.n_steps)));
        let gradient = gradient.of_weights.parameters().map(|sum| *sum / n as f32);
        for ((weight, slope), moments) in model.parameters().zip(gradient).zip(&mut self.moments) {
            for ((moment, decay), value) in moments
                .iter_mut()
                .zip(Self::DECAY)
                .zip([slope, slope * slope])
            {
                *moment = decay * *moment + (1.0 - decay) * value;
            }
            let [first, second] = [0, 1].map(|i| moments[i] * unbiased[i]);
            *weight -= rate * first / (second.sqrt() + 1e-8);
        }
    }
}

/// Mean and inverse standard deviation of each feature.
struct Standardisation {
    mean: Vec<f32>,
    scale: Vec<f32>,
}

impl Standardisation {
    fn of(examples: &LabelledRows<'_>) -> Self {
        let mut sums = vec![[0.0_f64; 2]; examples.n_features];
        for row in examples.features.chunks_exact(examples.n_features) {
            for ([sum, squares], &x) in sums.iter_mut().zip(row) {
                *sum += f64::from(x);
                *squares += f64::from(x) * f64::from(x);
            }
        }
        let n = examples.labels.len().max(1) as f64;
        let scale = |[sum, squares]: &[f64; 2]| {
            let variance = squares / n - (sum / n).powi(2);
            (1.0 / variance.max(1e-12).sqrt()) as f32
        };
        Self {
            mean: sums.iter().map(|[sum, _]| (sum / n) as f32).collect(),
            scale: sums.iter().map(scale).collect(),
        }
    }

    fn apply(&self, features: &[f32]) -> Vec<f32> {
        let laws = self.mean.iter().zip(&self.scale).cycle();
        let values = features.iter().zip(laws);
        values
            .map(|(x, (mean, scale))| (x - mean) * scale)
            .collect()
    }

    /// Make the weights for standardised features apply to the features as they are.
    fn fold_into(&self, model: &mut Perceptron) {
        for unit in &mut model.hidden {
            let laws = self.mean.iter().zip(&self.scale);
            for (weight, (mean, scale)) in unit.weights.iter_mut().zip(laws) {
                *weight *= scale;
                unit.bias -= *weight * mean;
            }
        }
    }
}

/// Standard normal value (Box and Muller 1958).
fn normal(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - random.unit()).ln()).sqrt();
    radius * (TAU * random.unit()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: PerceptronConfig = PerceptronConfig {
        n_hidden: 8,
        n_epochs: 60,
        batch: 32,
        learning_rate: 0.02,
        seed: 3,
    };

    /// Rows of two features, labelled by a rule that no linear unit can express; the second
    /// feature has another mean and scale.
    fn rows(n: usize, seed: u64) -> (Vec<f32>, Vec<bool>) {
        let mut random = Random::from_seed(seed);
        let mut labels = Vec::new();
        let features = (0..n).flat_map(|_| {
            let [a, b] = [random.unit_f32(), random.unit_f32()];
            labels.push((a > 0.5) != (b > 0.5));
            [a, 300.0 + 40.0 * b]
        });
        (features.collect(), labels)
    }

    #[test]
    fn an_interaction_of_features_is_learned() {
        let (features, labels) = rows(2_000, 1);
        let examples = LabelledRows {
            features: &features,
            n_features: 2,
            labels: &labels,
        };
        let model = Perceptron::train(&examples, &CONFIG, || ());
        let (unseen, truths) = rows(500, 2);
        let right = unseen
            .chunks_exact(2)
            .zip(&truths)
            .filter(|(row, truth)| (model.log_odds(row) > 0.0) == **truth);
        assert!(right.count() > 460);
        assert_eq!(model, Perceptron::train(&examples, &CONFIG, || ()));
    }

    #[test]
    fn the_gradient_is_that_of_the_loss() {
        let mut model = Perceptron::random(2, 4, &mut Random::from_seed(5));
        let inputs = [0.7, -0.4];
        let loss = |model: &Perceptron| f64::from(-model.log_odds(&inputs)).exp().ln_1p();
        let mut gradient = Gradient::of(&model);
        gradient.add(&model, &inputs, true);
        let expected: Vec<f32> = gradient
            .of_weights
            .parameters()
            .map(|value| *value)
            .collect();
        for (i, expected) in expected.iter().enumerate() {
            let mut shifted = |by: f32| {
                *model.parameters().nth(i).unwrap() += by;
                loss(&model)
            };
            let slope = (shifted(1e-3) - shifted(-2e-3)) / 2e-3;
            shifted(1e-3);
            assert!((slope - f64::from(*expected)).abs() < 1e-3, "{i}");
        }
    }
}
