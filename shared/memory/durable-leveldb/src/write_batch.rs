//! Batch of writes that is applied atomically.

/// Records to be written and deleted together, in order.
#[derive(Debug, Default)]
pub struct WriteBatch {
    records: Vec<BatchRecord>,
}

/// Key of a record and its new value; `None` deletes it.
pub(crate) type BatchRecord = (Vec<u8>, Option<Vec<u8>>);

impl WriteBatch {
    /// Adds the writing of a record.
    pub fn put(&mut self, key: &[u8], value: &[u8]) {
        self.records.push((key.to_vec(), Some(value.to_vec())));
    }

    /// Adds the deletion of a record.
    pub fn delete(&mut self, key: &[u8]) {
        self.records.push((key.to_vec(), None));
    }

    /// Number of writes and deletions.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// `true` without any write or deletion.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Encodes the batch as LevelDB does in its log: sequence number of the first record, number of
    /// records, and the records.
    pub(crate) fn encode(&self, sequence: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        bytes.extend(sequence.to_le_bytes());
        bytes.extend((self.records.len() as u32).to_le_bytes());
        for (key, value) in &self.records {
            bytes.push(value.is_some() as u8);
            put_slice(&mut bytes, key);
            if let Some(value) = value {
                put_slice(&mut bytes, value);
            }
        }
        bytes
    }

    pub(crate) fn into_records(self) -> Vec<BatchRecord> {
        self.records
    }
}

fn put_slice(bytes: &mut Vec<u8>, slice: &[u8]) {
    let mut n_left = slice.len();
    while n_left >= 0x80 {
        bytes.push(n_left as u8 | 0x80);
        n_left >>= 7;
    }
    bytes.push(n_left as u8);
    bytes.extend_from_slice(slice);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batch_is_encoded_as_leveldb_does() {
        let value = vec![7; 300];
        let mut ours = WriteBatch::default();
        let mut theirs = rusty_leveldb::WriteBatch::default();
        ours.put(b"cup", &value);
        theirs.put(b"cup", &value);
        ours.delete(b"mug");
        theirs.delete(b"mug");
        assert_eq!(ours.encode(1 << 40), theirs.encode(1 << 40));
    }
}
