// Prints every record of a LevelDB database; fails if the database is damaged.
//
//   dump FOLDER
//
// First a line `levels` with the number of tables on each level, then a line for
// each record. Every record is also looked up by its key, which exercises the
// index and the Bloom filter of its table.

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "leveldb/db.h"
#include "leveldb/filter_policy.h"
#include "record.h"

namespace {

void Check(const leveldb::Status& status, const char* doing) {
  if (status.ok()) return;
  fprintf(stderr, "dump: %s: %s\n", doing, status.ToString().c_str());
  exit(1);
}

void PrintLevels(leveldb::DB* db) {
  printf("levels");
  std::string n_tables;
  for (int level = 0;
       db->GetProperty("leveldb.num-files-at-level" + std::to_string(level), &n_tables); level++) {
    printf(" %s", n_tables.c_str());
  }
  printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: dump FOLDER\n");
    return 2;
  }
  std::unique_ptr<const leveldb::FilterPolicy> filter(leveldb::NewBloomFilterPolicy(10));
  leveldb::Options options;
  options.create_if_missing = false;
  options.paranoid_checks = true;
  options.filter_policy = filter.get();
  leveldb::DB* opened = nullptr;
  Check(leveldb::DB::Open(options, argv[1], &opened), "opening");
  std::unique_ptr<leveldb::DB> db(opened);
  PrintLevels(db.get());

  leveldb::ReadOptions reading;
  reading.verify_checksums = true;
  std::unique_ptr<leveldb::Iterator> records(db->NewIterator(reading));
  std::string value;
  for (records->SeekToFirst(); records->Valid(); records->Next()) {
    Check(db->Get(reading, records->key(), &value), "looking up a key that is there");
    if (records->value() != value) {
      fprintf(stderr, "dump: a key has two values\n");
      return 1;
    }
    PrintRecord(records->key(), value);
  }
  Check(records->status(), "reading");
  return 0;
}
