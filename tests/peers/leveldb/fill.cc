// Writes a LevelDB test database and prints every record that it must contain.
//
//   fill FOLDER snappy|plain
//
// Keys and values of many lengths, batches that put and delete, tables on
// several levels with filters, and a log with the last writes.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>

#include "leveldb/db.h"
#include "leveldb/filter_policy.h"
#include "leveldb/write_batch.h"
#include "record.h"

namespace {

constexpr int kBatches = 4000;

void Check(const leveldb::Status& status, const char* doing) {
  if (status.ok()) return;
  fprintf(stderr, "fill: %s: %s\n", doing, status.ToString().c_str());
  exit(1);
}

// SplitMix64 (Steele et al. 2014).
uint64_t Random() {
  static uint64_t state = 1;
  uint64_t z = state += 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

// Random key from a small set, so that many keys are overwritten or deleted.
// Never empty: rusty-leveldb panics when it writes a block that ends with the empty key.
std::string Key() {
  const uint64_t n = Random() % 20000;
  std::string key(1 + n % 40, static_cast<char>(n));
  for (size_t i = 0; i < key.size() && i < 4; i++) key[i] = static_cast<char>(n >> (3 * i));
  return key;
}

// Random value: sometimes empty or longer than a log block; half are compressible.
std::string Value() {
  const bool is_long = Random() % 200 == 0;
  std::string value(Random() % (is_long ? 200000 : 2000), '\0');
  if (Random() % 16 == 0) value.clear();
  const uint64_t mask = Random() % 2 == 0 ? 0x3 : 0xff;
  for (char& byte : value) byte = static_cast<char>(Random() & mask);
  return value;
}

void Fill(leveldb::DB* db, std::map<std::string, std::string>* expected) {
  for (int batch_idx = 0; batch_idx < kBatches; batch_idx++) {
    leveldb::WriteBatch batch;
    for (uint64_t n = 1 + Random() % 20; n > 0; n--) {
      const std::string key = Key();
      if (Random() % 4 == 0) {
        batch.Delete(key);
        expected->erase(key);
      } else {
        const std::string value = Value();
        batch.Put(key, value);
        (*expected)[key] = value;
      }
    }
    Check(db->Write(leveldb::WriteOptions(), &batch), "writing");
    if (batch_idx == kBatches / 2) db->CompactRange(nullptr, nullptr);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string compression = argc == 3 ? argv[2] : "";
  if (compression != "snappy" && compression != "plain") {
    fprintf(stderr, "usage: fill FOLDER snappy|plain\n");
    return 2;
  }
  std::unique_ptr<const leveldb::FilterPolicy> filter(leveldb::NewBloomFilterPolicy(10));
  leveldb::Options options;
  options.create_if_missing = true;
  options.error_if_exists = true;
  options.write_buffer_size = 1 << 18;
  options.filter_policy = filter.get();
  options.compression =
      compression == "snappy" ? leveldb::kSnappyCompression : leveldb::kNoCompression;
  leveldb::DB* db = nullptr;
  Check(leveldb::DB::Open(options, argv[1], &db), "opening");
  std::map<std::string, std::string> expected;
  Fill(db, &expected);
  delete db;
  // LevelDB orders keys as unsigned bytes, and so does std::string.
  for (const auto& [key, value] : expected) PrintRecord(key, value);
  return 0;
}
