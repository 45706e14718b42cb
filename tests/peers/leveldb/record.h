// Text form of a record: key in hex, length of the value, CRC-32 of the value.

#ifndef TABULA_PEERS_RECORD_H
#define TABULA_PEERS_RECORD_H

#include <cstdint>
#include <cstdio>

#include "leveldb/slice.h"

// CRC-32 of zlib: polynomial 0xedb88320, reflected.
inline uint32_t Crc32(const leveldb::Slice& bytes) {
  uint32_t crc = ~0u;
  for (size_t i = 0; i < bytes.size(); i++) {
    crc ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; bit++) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

inline void PrintRecord(const leveldb::Slice& key, const leveldb::Slice& value) {
  for (size_t i = 0; i < key.size(); i++) printf("%02x", static_cast<unsigned char>(key[i]));
  printf(" %zu %08x\n", value.size(), Crc32(value));
}

#endif
