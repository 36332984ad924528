//! Groups of a few coupled rows, for coarse levels.
const FREE: u32 = u32::MAX;

/// A division of rows into groups.
#[derive(Default)]
pub struct Groups {
    /// Group of each row.
    of: Vec<u32>,
    /// Rows of each group, one group after another, each in ascending order; and the start of each group.
    member: Vec<u32>,
    first: Vec<u32>,
}

impl Groups {
    /// Groups `n` rows, nearest in storage order first; `others(i, list)` appends the rows coupled to row `i` to a
    /// list.
    ///
    /// A group has at most `size` rows, apart from single rows that join it. If too few neighbours are free, neighbours
    /// of neighbours join. Smaller groups would couple to so many others that the coarse rows in 3-D would take a third
    /// of all memory.
    pub fn new(n: usize, size: usize, others: impl Fn(usize, &mut Vec<u32>)) -> Self {
        let mut of = vec![FREE; n];
        let mut count = 0;
        let (mut near, mut seen) = (Vec::<u32>::new(), Vec::new());
        for i in 0..n {
            if of[i] != FREE {
                continue;
            }
            seen.clear();
            others(i, &mut seen);
            seen.sort_unstable_by_key(|j| (j.abs_diff(i as u32), *j));
            seen.dedup();
            near.clear();
            near.extend(seen.iter().filter(|j| of[**j as usize] == FREE && **j as usize != i));
            if near.is_empty() && size > 1 {
                // a single row joins the group of its nearest neighbour
                if let Some(j) = seen.iter().find(|j| **j as usize != i) {
                    of[i] = of[*j as usize];
                    continue;
                }
            }
            of[i] = count;
            near.truncate(size.saturating_sub(1));
            near.iter().for_each(|j| of[*j as usize] = count);
            let left = size.saturating_sub(1 + near.len());
            if left > 0 {
                seen.clear();
                near.iter().for_each(|j| others(*j as usize, &mut seen));
                seen.retain(|j| of[*j as usize] == FREE);
                seen.sort_unstable_by_key(|j| (j.abs_diff(i as u32), *j));
                seen.dedup();
                seen.iter().take(left).for_each(|j| of[*j as usize] = count);
            }
            count += 1;
        }
        let (member, first) = members(&of, count as usize);
        Self { of, member, first }
    }

    /// Number of groups.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// True if there are no groups.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Group of each row.
    pub fn of(&self) -> &[u32] {
        &self.of
    }

    /// Rows of group `g` in ascending order.
    pub fn members(&self, g: usize) -> &[u32] {
        &self.member[self.first[g] as usize..self.first[g + 1] as usize]
    }

    /// Memory in use (bytes).
    pub fn bytes(&self) -> usize {
        4 * (self.of.len() + self.member.len() + self.first.len())
    }
}

/// Rows of each of `n` groups, one group after another, each in ascending order; and the start of each group.
fn members(group: &[u32], n: usize) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0; n + 1];
    group.iter().for_each(|g| first[*g as usize + 1] += 1);
    (0..n).for_each(|g| first[g + 1] += first[g]);
    let (mut next, mut member) = (first.clone(), vec![0; group.len()]);
    for (i, g) in group.iter().enumerate() {
        member[next[*g as usize] as usize] = i as u32;
        next[*g as usize] += 1;
    }
    (member, first)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows on a line, each coupled to the two beside it.
    fn line(n: usize) -> impl Fn(usize, &mut Vec<u32>) {
        move |i, list| {
            list.extend((i > 0).then(|| i as u32 - 1));
            list.extend((i + 1 < n).then_some(i as u32 + 1));
        }
    }

    #[test]
    fn every_row_is_in_one_group() {
        let groups = Groups::new(10, 4, line(10));
        let all: Vec<u32> = (0..groups.len()).flat_map(|g| groups.members(g).to_vec()).collect();
        assert_eq!(all, (0..10).collect::<Vec<u32>>());
        assert!((0..groups.len()).all(|g| groups.members(g).len() <= 4));
        assert!(all.iter().all(|i| groups.members(groups.of()[*i as usize] as usize).contains(i)));
    }

    #[test]
    fn neighbours_of_neighbours_fill_groups() {
        // a row couples to two others: a third member comes from their neighbours
        let groups = Groups::new(60, 3, line(60));
        assert_eq!(groups.len(), 20);
    }
}
