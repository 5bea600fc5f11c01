/* A child for each input: it prints into a file, and has neither endless time nor endless memory. Time is the
   processor's, so that a busy machine is no hang; one that waits for ever is ended by the clock. */
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { is_child = -1000, failed = -999, seconds = 30, seconds_by_the_clock = 600 };

static void limit_memory(void) {
#ifndef SANITIZED /* the address sanitizer reserves terabytes */
  struct rlimit memory = {(rlim_t)800 << 20, (rlim_t)800 << 20};
  setrlimit(RLIMIT_AS, &memory);
#endif
}

int fuzz_split(const char *path) {
  int status;
  pid_t child = fork();
  if (child == 0) {
    struct rlimit no_core = {0, 0}, time = {seconds, seconds + 1};
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(file, 1);
    dup2(file, 2);
    close(0);
    setrlimit(RLIMIT_CORE, &no_core);
    limit_memory();
    setrlimit(RLIMIT_CPU, &time);
    alarm(seconds_by_the_clock);
    return is_child;
  }
  if (child < 0 || waitpid(child, &status, 0) < 0) return failed;
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}
