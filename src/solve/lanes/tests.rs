use super::*;

/// Fills the halos of a row.
struct FillHalos<'a, T>(Layout, &'a mut [T]);

impl<T: Number> WithRows<T> for FillHalos<'_, T> {
    type Output = ();

    fn run<S: Simd, const H: usize>(self, rows: Rows<S, H, T>) {
        self.0.fill_halos(rows, self.1);
    }
}

/// Neighbours of every spring are in the rows before and after, of one chain in pieces and of several chains.
#[test]
fn neighbours_are_in_the_next_rows() {
    for springs in [&[0][..], &[6], &[7], &[63], &[64], &[200], &[3, 9, 5], &[40; LANES]] {
        let layout = Layout::new(springs);
        let mut row = vec![0.0; layout.len()];
        for (chain, &springs) in springs.iter().enumerate() {
            layout.put(&mut row, chain, (0..=springs).map(|n| 1.0 + n as f64));
        }
        let mut single: Vec<f32> = row.iter().map(|x| *x as f32).collect();
        let mut by_scalars = row.clone();
        dispatch(FillHalos(layout, &mut row));
        dispatch(FillHalos(layout, &mut single));
        FillHalos(layout, &mut by_scalars).run(Rows::<_, LANES>(pulp::Scalar, PhantomData));
        assert_eq!(row, by_scalars);
        assert!(row.iter().zip(&single).all(|(a, b)| *a == f64::from(*b)));
        for (chain, &springs) in springs.iter().enumerate() {
            assert_eq!(layout.gather(&row, chain, springs + 1).last(), Some(&(1.0 + springs as f64)));
            for number in 0..=springs {
                let place = layout.place(chain, number);
                assert_eq!(layout.number(place / LANES, place % LANES), number);
                let (before, after) = (number as f64, if number < springs { number as f64 + 2.0 } else { 0.0 });
                assert_eq!([row[place - LANES], row[place], row[place + LANES]], [before, number as f64 + 1.0, after]);
                for offset in [-12, -3, -1, 0, 2, 12] {
                    let there = number as f64 + 1.0 + offset as f64;
                    let there = if there >= 1.0 && there <= springs as f64 + 1.0 { there } else { 0.0 };
                    assert_eq!(layout.beside(&row, place / LANES, offset)[place % LANES], there, "{springs} {number}");
                }
            }
        }
        let rows: usize = (0..layout.blocks()).map(|block| layout.block(block).len()).sum();
        assert_eq!(rows, layout.rows);
        for block in 0..layout.blocks() {
            assert!(layout.block(block).all(|row| layout.block_of(row) == block));
        }
    }
}

/// Rows begin at cache lines, copies too.
#[test]
fn rows_are_aligned() {
    for len in [8, 24, 1000] {
        let numbers = Aligned::new(len, 1.5);
        let copy = numbers.clone();
        assert_eq!((copy.as_ptr() as usize % 64, numbers.as_ptr() as usize % 64), (0, 0));
        assert!(copy.len() == len && copy.iter().all(|x| *x == 1.5));
    }
}
