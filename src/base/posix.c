/* What Fortran has no words for: signals, files that are safe on the disk, space, numbered files.
 * Called from module sgmp_posix, which says what each function is for. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t received = 0;

static void note(int number)
{
  received = number;
}

/* SIGTERM, SIGUSR1 and SIGXCPU are noted; a file that outgrows its limit is an error, not the end. */
void sgmp_signals_watch(void)
{
  const int watched[] = {SIGTERM, SIGUSR1, SIGXCPU};
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < sizeof watched/sizeof *watched; i++) sigaction(watched[i], &action, NULL);
  signal(SIGXFSZ, SIG_IGN);
}

/* 0: none, 1: SIGTERM, 2: SIGUSR1, 3: SIGXCPU. */
int sgmp_signal_seen(void)
{
  switch (received) {
    case SIGTERM: return 1;
    case SIGUSR1: return 2;
    case SIGXCPU: return 3;
    default: return 0;
  }
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

/* Gives an environment variable a value unless it has one. */
void sgmp_environment_default(const char *name, const char *value)
{
  setenv(name, value, 0);
}
