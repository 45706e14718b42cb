// Replay benchmark: C++ LevelDB performs the durable writes of tabula's store.
//
//   teach write FOLDER TRACE FIRST COUNT CALLERS
//       Writes batches of the trace, each synced, from several threads. Prints
//       the nanoseconds it took, then those of each batch.
//   teach beside views|compaction FOLDER TRACE FIRST COUNT VIEWS_FIRST VIEWS_COUNT CALLERS
//       Writes batches of the trace from one thread, for as long as others write
//       the batches of views, or one compacts the database. Prints as `write`.
//   teach load FOLDER
//       Opens the database, reads all records but the clouds, and keeps the
//       descriptors. Prints milliseconds until it was open and in all, number of
//       descriptors, and kilobytes of memory in use and at most.
//   teach copy FROM TO
//       Writes all records of a database into a new one.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "leveldb/db.h"
#include "leveldb/filter_policy.h"
#include "leveldb/write_batch.h"
#include "trace.h"

namespace {

using Clock = std::chrono::steady_clock;
using Batches = std::vector<leveldb::WriteBatch>;

// First byte of the keys of descriptors and of clouds.
constexpr char kDescriptor = 'd';
constexpr char kPoints = 'p';
// Number of records per batch of a copy.
constexpr int kCopiedTogether = 128;

void Check(const leveldb::Status& status) {
  if (!status.ok()) Fail(status.ToString());
}

int64_t NanosecondsSince(Clock::time_point begin) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

// LevelDB with its defaults and the settings of tabula's store: no compression,
// Bloom filters, and checksums verified on every read.
std::unique_ptr<leveldb::DB> Open(const std::string& folder) {
  static const leveldb::FilterPolicy* const filter = leveldb::NewBloomFilterPolicy(10);
  leveldb::Options options;
  options.create_if_missing = true;
  options.compression = leveldb::kNoCompression;
  options.filter_policy = filter;
  options.paranoid_checks = true;
  leveldb::DB* db = nullptr;
  Check(leveldb::DB::Open(options, folder, &db));
  return std::unique_ptr<leveldb::DB>(db);
}

// Latency of a synced write, nanoseconds.
int64_t WriteSynced(leveldb::DB* db, leveldb::WriteBatch* batch) {
  leveldb::WriteOptions durable;
  durable.sync = true;
  const auto begin = Clock::now();
  Check(db->Write(durable, batch));
  return NanosecondsSince(begin);
}

// Writes all batches from several threads and returns their latencies, nanoseconds.
std::vector<int64_t> WriteAll(leveldb::DB* db, Batches* batches, int n_callers) {
  std::vector<int64_t> latencies_ns(batches->size());
  std::atomic<size_t> next{0};
  std::vector<std::thread> callers;
  for (int caller = 0; caller < n_callers; caller++) {
    callers.emplace_back([&] {
      for (size_t i = next++; i < batches->size(); i = next++) {
        latencies_ns[i] = WriteSynced(db, &(*batches)[i]);
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  return latencies_ns;
}

void Print(int64_t elapsed_ns, const std::vector<int64_t>& latencies_ns) {
  printf("%lld\n", static_cast<long long>(elapsed_ns));
  for (int64_t ns : latencies_ns) printf("%lld\n", static_cast<long long>(ns));
}

void Write(char** arguments) {
  Batches batches = ReadTrace(arguments[1], atoi(arguments[2]), atoi(arguments[3]));
  const auto db = Open(arguments[0]);
  const auto begin = Clock::now();
  const auto latencies_ns = WriteAll(db.get(), &batches, atoi(arguments[4]));
  Print(NanosecondsSince(begin), latencies_ns);
}

void WriteBeside(char** arguments) {
  const bool is_compaction = strcmp(arguments[0], "compaction") == 0;
  Batches batches = ReadTrace(arguments[2], atoi(arguments[3]), atoi(arguments[4]));
  Batches views = ReadTrace(arguments[2], atoi(arguments[5]), atoi(arguments[6]));
  const auto db = Open(arguments[1]);
  std::atomic<bool> is_over{false};
  const auto begin = Clock::now();
  std::thread other([&] {
    if (is_compaction) {
      db->CompactRange(nullptr, nullptr);
    } else {
      WriteAll(db.get(), &views, atoi(arguments[7]));
    }
    is_over = true;
  });
  std::vector<int64_t> latencies_ns;
  for (size_t i = 0; i < batches.size() && !is_over; i++) {
    latencies_ns.push_back(WriteSynced(db.get(), &batches[i]));
  }
  other.join();
  Print(NanosecondsSince(begin), latencies_ns);
}

// Field of /proc/self/status, kilobytes.
std::string MemoryKilobytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word == name + ":" && status >> word) return word;
  }
  Fail("/proc/self/status has no " + name);
}

void Load(char** arguments) {
  const auto begin = Clock::now();
  const auto db = Open(arguments[0]);
  const int64_t opening_ns = NanosecondsSince(begin);
  leveldb::ReadOptions reading;
  reading.verify_checksums = true;
  std::unique_ptr<leveldb::Iterator> records(db->NewIterator(reading));
  std::vector<std::string> descriptors;
  for (records->SeekToFirst(); records->Valid(); records->Next()) {
    if (records->key()[0] == kPoints) {
      records->Seek(std::string(1, kPoints + 1));
      if (!records->Valid()) break;
    }
    const leveldb::Slice value = records->value();
    if (records->key()[0] == kDescriptor) descriptors.push_back(value.ToString());
  }
  Check(records->status());
  printf("%f %f %zu %s %s\n", opening_ns / 1e6, NanosecondsSince(begin) / 1e6,
         descriptors.size(), MemoryKilobytes("VmRSS").c_str(), MemoryKilobytes("VmHWM").c_str());
}

void Copy(char** arguments) {
  const auto from = Open(arguments[0]);
  const auto to = Open(arguments[1]);
  std::unique_ptr<leveldb::Iterator> records(from->NewIterator(leveldb::ReadOptions()));
  leveldb::WriteBatch batch;
  int n_gathered = 0;
  for (records->SeekToFirst(); records->Valid(); records->Next()) {
    batch.Put(records->key(), records->value());
    if (++n_gathered % kCopiedTogether == 0) {
      Check(to->Write(leveldb::WriteOptions(), &batch));
      batch.Clear();
    }
  }
  Check(records->status());
  WriteSynced(to.get(), &batch);
}

}  // namespace

int main(int argc, char** argv) {
  const struct {
    const char* verb;
    int n_arguments;
    void (*run)(char**);
  } verbs[] = {{"write", 5, Write}, {"beside", 8, WriteBeside}, {"load", 1, Load}, {"copy", 2, Copy}};
  for (const auto& verb : verbs) {
    if (argc == verb.n_arguments + 2 && strcmp(argv[1], verb.verb) == 0) {
      verb.run(argv + 2);
      return 0;
    }
  }
  fprintf(stderr, "teach: unknown command or wrong number of arguments; see teach.cc\n");
  return 2;
}
