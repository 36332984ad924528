//! Weighted fits of vector fields at a point to values at scattered nodes (Lancaster and Salkauskas 1981).
//!
//! The field is the combination of a few basis fields that is nearest to the values, each with its own weight. The
//! result, e.g. the field at a point, is expressed as weights of the values. Basis fields that the nodes cannot
//! distinguish from earlier ones are omitted, so that nodes on a line or a plane, or too few nodes, need no special
//! treatment. A field in the span of the remaining basis fields is reproduced to round-off.

/// Maximum fraction of a basis field that remains after subtraction of earlier ones for it to be regarded as dependent
/// on them.
const NEW: f64 = 1e-7;

/// A basis field.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Values at the nodes, all components one after another.
    pub at_nodes: Vec<f64>,
    /// The requested results for this basis field, e.g. its components at a point.
    pub asked: Vec<f64>,
}

/// Weights of the values at the nodes in each requested result, stored as one row of weights for each result;
/// `of_values` are the weights of the values in the fit.
pub fn weights(basis: Vec<Basis>, of_values: &[f64]) -> Vec<f64> {
    let asked = basis.first().map_or(0, |b| b.asked.len());
    let n = of_values.len();
    let root: Vec<f64> = of_values.iter().map(|w| w.sqrt()).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut known: Vec<Basis> = Vec::new();
    for mut field in basis {
        field.at_nodes.iter_mut().zip(&root).for_each(|(v, w)| *v *= w);
        let size = dot(&field.at_nodes, &field.at_nodes).sqrt();
        // two passes are sufficient (Giraud et al. 2005)
        for _ in 0..2 {
            for q in &known {
                let part = dot(&q.at_nodes, &field.at_nodes);
                field.at_nodes.iter_mut().zip(&q.at_nodes).for_each(|(v, q)| *v -= part * q);
                field.asked.iter_mut().zip(&q.asked).for_each(|(v, q)| *v -= part * q);
            }
        }
        let left = dot(&field.at_nodes, &field.at_nodes).sqrt();
        if left > NEW * size {
            field.at_nodes.iter_mut().for_each(|v| *v /= left);
            field.asked.iter_mut().for_each(|v| *v /= left);
            known.push(field);
        }
    }
    let mut all = vec![0.0; asked * n];
    for q in &known {
        for (row, asked) in all.chunks_exact_mut(n.max(1)).zip(&q.asked) {
            row.iter_mut().zip(q.at_nodes.iter().zip(&root)).for_each(|(sum, (v, w))| *sum += asked * v * w);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Powers of x at the positions `x`, with their value and slope at 0.3.
    fn powers(x: &[f64]) -> Vec<Basis> {
        (0..3)
            .map(|p| Basis {
                at_nodes: x.iter().map(|x| x.powi(p)).collect(),
                asked: vec![0.3f64.powi(p), f64::from(p) * 0.3f64.powi(p - 1)],
            })
            .collect()
    }

    #[test]
    fn what_is_in_the_span_comes_back_and_few_nodes_span_less() {
        let x = [0.0, 0.2, 0.5, 0.6, 1.0];
        let found = weights(powers(&x), &[1.0, 3.0, 0.5, 2.0, 1.0]);
        let of =
            |row: usize, f: fn(f64) -> f64| found[row * 5..][..5].iter().zip(x).map(|(w, x)| w * f(x)).sum::<f64>();
        assert!((of(0, |x| 1.0 - 2.0 * x + 3.0 * x * x) - 0.67).abs() < 1e-13);
        assert!((of(1, |x| 1.0 - 2.0 * x + 3.0 * x * x) + 0.2).abs() < 1e-12);
        // two nodes do not determine a parabola
        let few = weights(powers(&x[..2]), &[1.0; 2]);
        assert!((few[0] - -0.5).abs() < 1e-13 && (few[1] - 1.5).abs() < 1e-13 && (few[3] - 5.0).abs() < 1e-12);
    }
}
