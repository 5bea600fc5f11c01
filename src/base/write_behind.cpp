// Files that a thread of its own writes while the others compute. Called from module sgmp_write_behind, which says what
// each function is for.
//
// Bytes wait in blocks of one megabyte, in the order in which they came; who brings more than there is room for waits.
// One thread writes, so that files appear in the order in which they were closed. After a failure no file is put in
// its place any more: a list of files must not name one that is not there.
#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace {

const std::size_t block_size = 1048576;
const std::size_t lendable = 64; // blocks at once
const std::size_t kept = 64; // blocks that stay for the next file: new ones are memory that nobody has touched

using block_t = std::unique_ptr<char[]>;

// What the thread does next: writes a block, or with bytes = 0 closes the file and puts it in its place.
struct task_t {
  std::FILE *stream = nullptr;
  block_t block;
  std::size_t bytes = 0;
  std::string path, target;
};

class writer_t {
public:
  explicit writer_t(std::int64_t limit)
    : most(std::max<std::size_t>(2, limit/block_size)), thread([this] { work(); }) {}

  ~writer_t()
  {
    {
      std::lock_guard<std::mutex> lock(guard);
      stopping = true;
    }
    changed.notify_all();
    thread.join();
  }

  void put(std::FILE *stream, const char *bytes, std::size_t n)
  {
    while (n > 0) {
      if (!open.block) {
        open.stream = stream;
        open.block = take_block();
        open.bytes = 0;
      }
      const auto part = std::min(n, block_size - open.bytes);
      std::memcpy(open.block.get() + open.bytes, bytes, part);
      open.bytes += part;
      bytes += part;
      n -= part;
      if (open.bytes == block_size) push(std::move(open));
    }
  }

  // Some empty blocks for bytes that are many, at least one, for `give` to get back when they are filled.
  int lend(int wanted, char **blocks)
  {
    const int n = std::max(1, std::min<int>(wanted, static_cast<int>(std::min<std::size_t>(most/2, lendable))));
    for (int i = 0; i < n; i++) {
      lent.push_back(take_block());
      blocks[i] = lent.back().get();
    }
    return n;
  }

  // The blocks that were lent last, filled with n bytes.
  void give(std::FILE *stream, std::size_t n)
  {
    if (open.block) push(std::move(open));
    for (auto &block : lent) {
      task_t task;
      task.stream = stream;
      task.bytes = std::min(n, block_size);
      task.block = std::move(block);
      n -= task.bytes;
      push(std::move(task));
    }
    lent.clear();
  }

  void close(std::FILE *stream, const char *path, const char *target)
  {
    if (open.block) push(std::move(open));
    task_t task;
    task.stream = stream;
    task.path = path;
    task.target = target;
    push(std::move(task));
  }

  // Returns when no file that is handed over will be closed at this path: it may be opened anew.
  void settle(const char *path)
  {
    const std::string name = path;
    std::unique_lock<std::mutex> lock(guard);
    changed.wait(lock, [this, &name] {
      return !(busy && closing == name) &&
             std::none_of(tasks.begin(), tasks.end(), [&name](const task_t &task) { return task.path == name; });
    });
  }

  // Returns when all is written; the system's number of the first failure since the last call, 0 for none.
  int wait(char *path, std::size_t n)
  {
    std::unique_lock<std::mutex> lock(guard);
    changed.wait(lock, [this] { return tasks.empty() && !busy; });
    return take_failure(path, n);
  }

  // The same without waiting.
  int look(char *path, std::size_t n)
  {
    std::lock_guard<std::mutex> lock(guard);
    return take_failure(path, n);
  }

private:
  std::mutex guard;
  std::condition_variable changed;
  std::deque<task_t> tasks;
  std::vector<block_t> spare, lent;
  task_t open;                // block that is being filled
  std::size_t most, used = 0; // blocks
  bool busy = false, stopping = false;
  int failure = 0;   // not yet told
  bool told = false; // there was one
  std::string failed;
  std::string closing; // path of the task at hand, if it closes a file
  int number_of_write = 0; // the system's, of the last write that failed
  std::thread thread;      // last: it uses all of the above

  int take_failure(char *path, std::size_t n)
  {
    const int number = failure;
    if (number != 0) std::snprintf(path, n, "%s", failed.c_str());
    failure = 0;
    return number;
  }

  block_t take_block()
  {
    std::unique_lock<std::mutex> lock(guard);
    changed.wait(lock, [this] { return used < most; });
    used++;
    if (spare.empty()) return block_t(new char[block_size]);
    auto block = std::move(spare.back());
    spare.pop_back();
    return block;
  }

  void push(task_t &&task)
  {
    {
      std::lock_guard<std::mutex> lock(guard);
      tasks.push_back(std::move(task));
    }
    task = task_t();
    changed.notify_all();
  }

  void fail(const std::string &path)
  {
    const int number = errno;
    std::lock_guard<std::mutex> lock(guard);
    if (told) return;
    told = true;
    failure = number == 0 ? EIO : number;
    failed = path;
  }

  void work()
  {
    std::unique_lock<std::mutex> lock(guard);
    while (true) {
      changed.wait(lock, [this] { return stopping || !tasks.empty(); });
      if (tasks.empty()) return;
      task_t task = std::move(tasks.front());
      tasks.pop_front();
      busy = true;
      closing = task.path;
      const bool hopeless = told;
      lock.unlock();
      if (task.bytes > 0)
        write(task, hopeless);
      else
        finish(task, hopeless);
      lock.lock();
      busy = false;
      if (task.block) {
        used--;
        if (spare.size() < kept) spare.push_back(std::move(task.block));
      }
      changed.notify_all();
    }
  }

  // A failure is told at the end of the file, whose path comes with it; until then the stream keeps it.
  void write(const task_t &task, bool hopeless)
  {
    if (hopeless || std::ferror(task.stream)) return;
    errno = 0;
    if (std::fwrite(task.block.get(), 1, task.bytes, task.stream) != task.bytes) number_of_write = errno;
  }

  void finish(const task_t &task, bool hopeless)
  {
    bool good = !std::ferror(task.stream);
    const int before = number_of_write;
    number_of_write = 0;
    errno = 0;
    const bool closed = std::fclose(task.stream) == 0;
    if (!good) errno = before;
    good = good && closed;
    if (!good && !hopeless) fail(task.path);
    if (good && !hopeless && task.path != task.target) {
      good = std::rename(task.path.c_str(), task.target.c_str()) == 0;
      if (!good) fail(task.path);
    }
    if ((!good || hopeless) && task.path != task.target) std::remove(task.path.c_str());
  }

};

} // namespace

extern "C" {

// Fortran has no address of a text of any length.
const char *sgmp_text_address(const char *text)
{
  return text;
}

void *sgmp_writer_start(std::int64_t limit)
{
  try {
    return new writer_t(limit);
  } catch (...) {
    return nullptr; // no thread to be had: files are written at once
  }
}

void sgmp_writer_put(void *writer, void *stream, const char *bytes, std::size_t n)
{
  static_cast<writer_t *>(writer)->put(static_cast<std::FILE *>(stream), bytes, n);
}

int sgmp_writer_lend(void *writer, int wanted, char **blocks)
{
  return static_cast<writer_t *>(writer)->lend(wanted, blocks);
}

void sgmp_writer_give(void *writer, void *stream, std::size_t n)
{
  static_cast<writer_t *>(writer)->give(static_cast<std::FILE *>(stream), n);
}

// Bytes from `offset` on of what lies at an address, at most a block of them, into a block.
void sgmp_writer_fill(char *block, const char *bytes, std::size_t offset, std::size_t n)
{
  std::memcpy(block, bytes + offset, std::min(n - offset, block_size));
}

void sgmp_writer_close(void *writer, void *stream, const char *path, const char *target)
{
  static_cast<writer_t *>(writer)->close(static_cast<std::FILE *>(stream), path, target);
}

void sgmp_writer_settle(void *writer, const char *path)
{
  static_cast<writer_t *>(writer)->settle(path);
}

int sgmp_writer_wait(void *writer, char *path, std::size_t n)
{
  return static_cast<writer_t *>(writer)->wait(path, n);
}

int sgmp_writer_look(void *writer, char *path, std::size_t n)
{
  return static_cast<writer_t *>(writer)->look(path, n);
}

void sgmp_writer_stop(void *writer)
{
  delete static_cast<writer_t *>(writer);
}

} // extern "C"
