//! Colours: green, and red and blue less green, each as differences along the order.

use super::record::Record;

/// Three planes of one byte a splat.
#[must_use]
pub fn split(records: &[Record]) -> Vec<u8> {
    let mut planes = Vec::with_capacity(3 * records.len());
    for plane in 0..3 {
        let mut last = 0_u8;
        for record in records {
            let [r, g, b] = record.color;
            let value = [g, r.wrapping_sub(g), b.wrapping_sub(g)][plane];
            planes.push(value.wrapping_sub(last));
            last = value;
        }
    }
    planes
}

/// Undoes [`split`]; `planes` holds three bytes a splat.
#[must_use]
pub fn join(planes: &[u8]) -> Vec<[u8; 3]> {
    let count = planes.len() / 3;
    let mut last = [0_u8; 3];
    (0..count)
        .map(|n| {
            for (plane, value) in last.iter_mut().enumerate() {
                *value = value.wrapping_add(planes[plane * count + n]);
            }
            let [g, r, b] = last;
            [r.wrapping_add(g), g, b.wrapping_add(g)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        let colors: Vec<[u8; 3]> = (0..300_u32).map(|n| [n as u8, (n * 7) as u8, (n * n) as u8]).collect();
        let records: Vec<Record> =
            colors.iter().map(|&color| Record { color, ..Record::default() }).collect();
        assert_eq!(join(&split(&records)), colors);
    }
}
