/* What Fortran has no words for: signals, files that are safe on the disk, space, numbered files, locks, memory.
 * Called from module sgmp_posix, which says what each function is for. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static volatile sig_atomic_t received = 0;

static void note(int number)
{
  received = number;
}

/* SIGTERM, SIGUSR1, SIGXCPU and the first SIGINT are noted; the second SIGINT ends the program (a
 * background job of a shell ignores it). A file
 * that outgrows its limit is an error, not the end. */
void sgmp_signals_watch(void)
{
  const int watched[] = {SIGTERM, SIGUSR1, SIGXCPU, SIGINT};
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < sizeof watched/sizeof *watched; i++) {
    struct sigaction before;
    if (watched[i] == SIGINT && sigaction(SIGINT, NULL, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    action.sa_flags = watched[i] == SIGINT ? SA_RESTART | (int)SA_RESETHAND : SA_RESTART;
    sigaction(watched[i], &action, NULL);
  }
  signal(SIGXFSZ, SIG_IGN);
}

/* 0: none, 1: SIGTERM, 2: SIGUSR1, 3: SIGXCPU, 4: SIGINT. */
int sgmp_signal_seen(void)
{
  switch (received) {
    case SIGTERM: return 1;
    case SIGUSR1: return 2;
    case SIGXCPU: return 3;
    case SIGINT: return 4;
    default: return 0;
  }
}

/* Path of the program's file, at most n bytes with the end mark; its length, -1 where the system does not say. */
int64_t sgmp_program_path(char *path, int64_t n)
{
  const ssize_t length = readlink("/proc/self/exe", path, (size_t)n - 1);
  if (length >= 0) path[length] = '\0';
  return length;
}

/* Whether a path is a file, or a link to one: no pipe, device or folder, which may never end. */
int sgmp_file_regular(const char *path)
{
  struct stat found;
  return stat(path, &found) == 0 && S_ISREG(found.st_mode);
}

/* Removes a path if it is a symbolic link to a file, which what is written there would overwrite; devices stay. */
void sgmp_link_remove(const char *path)
{
  struct stat found;
  if (lstat(path, &found) == 0 && S_ISLNK(found.st_mode) && sgmp_file_regular(path)) unlink(path);
}

/* Waits until a file, or the entries of a folder, are on the disk; 0, or -1 with errno. */
int sgmp_file_sync(const char *path)
{
  const int file = open(path, O_RDONLY);
  if (file < 0) return -1;
  const int status = fsync(file);
  const int reason = errno;
  close(file);
  errno = reason;
  return status;
}

/* Whether a file of so many bytes can be had: makes it, without writing; 0, or -1 with errno. File
 * systems that cannot reserve space say nothing. */
int sgmp_file_reserve(const char *path, int64_t bytes)
{
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0) return -1;
  int status = 0, reason = 0;
#ifdef __linux__
  if (bytes > 0) status = fallocate(file, 0, 0, (off_t)bytes);
  if (status != 0) {
    reason = errno;
    if (reason == EOPNOTSUPP || reason == ENOSYS || reason == EINVAL) status = 0;
  }
#endif
  close(file);
  if (status != 0) unlink(path);
  errno = reason;
  return status;
}

/* Largest number below `below` of a file prefixNUMBERsuffix in a folder, -1: none. */
int64_t sgmp_file_number(const char *folder, const char *prefix, const char *suffix, int64_t below)
{
  int64_t largest = -1;
  DIR *entries = opendir(folder);
  if (entries == NULL) return largest;
  for (struct dirent *entry = readdir(entries); entry != NULL; entry = readdir(entries)) {
    const char *name = entry->d_name;
    if (strncmp(name, prefix, strlen(prefix)) != 0) continue;
    name += strlen(prefix);
    if (*name < '0' || *name > '9') continue;
    char *end;
    const int64_t number = strtoll(name, &end, 10);
    if (strcmp(end, suffix) == 0 && number < below && number > largest) largest = number;
  }
  closedir(entries);
  return largest;
}

/* The name of a file in a folder that ends with `suffix` and comes next after `after`; its length, 0: none. */
int64_t sgmp_file_next(const char *folder, const char *suffix, const char *after, char *name, int64_t n)
{
  char next[NAME_MAX + 1] = "";
  DIR *entries = opendir(folder);
  if (entries == NULL) return 0;
  for (struct dirent *entry = readdir(entries); entry != NULL; entry = readdir(entries)) {
    const char *found = entry->d_name;
    const size_t length = strlen(found), end = strlen(suffix);
    if (length <= end || length > (size_t)n || strcmp(found + length - end, suffix) != 0) continue;
    if (strcmp(found, after) <= 0 || (next[0] != 0 && strcmp(found, next) >= 0)) continue;
    strcpy(next, found);
  }
  closedir(entries);
  memcpy(name, next, strlen(next));
  return (int64_t)strlen(next);
}

/* Gives an environment variable a value unless it has one. */
void sgmp_environment_default(const char *name, const char *value)
{
  setenv(name, value, 0);
}

/* Starts the program anew, with the same arguments and one more variable, which the libraries it is linked to have
 * looked for before its first line. Returns if it cannot, or if any of the variables is there (names end with ""). */
void sgmp_start_anew_with(const char *names, const char *value)
{
  static char line[1 << 20];
  static char *arguments[1 << 16];
  for (const char *name = names; *name; name += strlen(name) + 1)
    if (getenv(name)) return;
  FILE *file = fopen("/proc/self/cmdline", "r");
  if (!file) return;
  const size_t length = fread(line, 1, sizeof line - 1, file);
  fclose(file);
  size_t n = 0;
  for (size_t at = 0; at < length; at += strlen(line + at) + 1) {
    if (n + 1 == sizeof arguments/sizeof *arguments) return;
    arguments[n++] = line + at;
  }
  if (n == 0 || length == sizeof line - 1 || setenv(names, value, 0) != 0) return;
  execv("/proc/self/exe", arguments);
}

/* Takes byte `rank` of a lock file for as long as the process lives. The first rank must find all bytes
 * free, so that processes left over from an earlier run keep a new one out. 0: taken; the number of a
 * process that has a byte; -1: the file system has no locks, -2: the file cannot be made (errno). */
int64_t sgmp_folder_lock(const char *path, int64_t rank)
{
  const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return -2;
  struct flock wanted = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = rank, .l_len = rank == 0 ? 0 : 1};
  if (fcntl(file, F_SETLK, &wanted) != 0) {
    if (errno != EACCES && errno != EAGAIN) return -1;
    if (fcntl(file, F_GETLK, &wanted) != 0 || wanted.l_type == F_UNLCK) return -1;
    return wanted.l_pid > 0 ? wanted.l_pid : INT64_MAX;
  }
  struct flock others = {.l_type = F_UNLCK, .l_whence = SEEK_SET, .l_start = 1, .l_len = 0};
  if (rank == 0) fcntl(file, F_SETLK, &others);
  return 0;
}

/* The number behind a word in a file such as /proc/meminfo, or the first one where the word is empty; -1:
 * there is none. */
static int64_t number_in_file(const char *path, const char *word)
{
  FILE *file = fopen(path, "r");
  if (file == NULL) return -1;
  char line[512];
  long long number = -1;
  while (fgets(line, sizeof line, file) != NULL) {
    if (strncmp(line, word, strlen(word)) != 0) continue;
    if (sscanf(line + strlen(word), " %lld", &number) != 1) number = -1;
    break;
  }
  fclose(file);
  return number;
}

/* What is left of the memory of a control group and of those around it (Linux, version 2). */
static int64_t left_in_groups(int64_t least)
{
  char group[1024] = "", path[1200];
  FILE *file = fopen("/proc/self/cgroup", "r");
  if (file == NULL) return least;
  while (fgets(group, sizeof group, file) != NULL && strncmp(group, "0::", 3) != 0) group[0] = 0;
  fclose(file);
  if (group[0] == 0) return least;
  group[strcspn(group, "\n")] = 0;
  for (;;) {
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.max", group + 3);
    const int64_t most = number_in_file(path, "");
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.stat", group + 3);
    const int64_t used = number_in_file(path, "anon");
    if (most >= 0 && used >= 0 && most - used < least) least = most - used;
    char *last = strrchr(group + 3, '/');
    if (last == NULL) return least;
    *last = 0;
  }
}

/* Bytes that this process and others on its machine can still have: what the machine, the control groups
 * and the limit on addresses leave; the largest number where nobody says. */
int64_t sgmp_memory_available(void)
{
  int64_t least = INT64_MAX;
  const int64_t free_kilobytes = number_in_file("/proc/meminfo", "MemAvailable:");
  if (free_kilobytes >= 0) least = 1024*free_kilobytes;
  least = left_in_groups(least);
  struct rlimit limit;
  const int64_t pages = number_in_file("/proc/self/statm", "");
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && pages >= 0) {
    const int64_t left = (int64_t)limit.rlim_cur - pages*sysconf(_SC_PAGESIZE);
    if (left < least) least = left;
  }
  return least;
}
