// Trace file of the write batches of tabula's store, one per mutation.
//
// A trace is a file of batches, each after its length in four bytes, in
// LevelDB's own form: sequence (8 bytes), count (4), then for each operation its
// kind (1: put, 0: delete), the key and, of a put, the value, each after its
// length as a varint. All numbers little-endian.

#ifndef TABULA_PEERS_TRACE_H
#define TABULA_PEERS_TRACE_H

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "leveldb/slice.h"
#include "leveldb/write_batch.h"

[[noreturn]] inline void Fail(const std::string& what) {
  fprintf(stderr, "teach: %s\n", what.c_str());
  exit(1);
}

// Takes a slice after its length as a varint: seven bits per byte, lowest first;
// the top bit means that more bytes follow.
inline leveldb::Slice TakeSlice(leveldb::Slice* rest) {
  uint32_t size = 0;
  for (int shift = 0; !rest->empty(); shift += 7) {
    const unsigned char byte = (*rest)[0];
    rest->remove_prefix(1);
    size |= static_cast<uint32_t>(byte & 0x7f) << shift;
    if (byte < 0x80) break;
  }
  if (size > rest->size()) Fail("the trace ends in the middle of a batch");
  const leveldb::Slice taken(rest->data(), size);
  rest->remove_prefix(size);
  return taken;
}

// Decodes one batch.
inline leveldb::WriteBatch Batch(leveldb::Slice rest) {
  leveldb::WriteBatch batch;
  rest.remove_prefix(12);
  while (!rest.empty()) {
    const bool is_put = rest[0] == 1;
    rest.remove_prefix(1);
    const leveldb::Slice key = TakeSlice(&rest);
    if (is_put) {
      batch.Put(key, TakeSlice(&rest));
    } else {
      batch.Delete(key);
    }
  }
  return batch;
}

// The batches `first` to `first + count - 1` of the trace.
inline std::vector<leveldb::WriteBatch> ReadTrace(const std::string& path, int first, int count) {
  std::ifstream file(path, std::ios::binary);
  std::vector<leveldb::WriteBatch> batches;
  uint32_t size = 0;
  for (int i = 0; i < first + count; i++) {
    if (!file.read(reinterpret_cast<char*>(&size), sizeof size)) Fail("the trace is too short");
    if (i < first) {
      file.seekg(size, std::ios::cur);
      continue;
    }
    std::string bytes(size, '\0');
    if (!file.read(&bytes[0], size) || size < 12) Fail("the trace is cut off");
    batches.push_back(Batch(bytes));
  }
  return batches;
}

#endif
