/* Which mutant is switched on (SGMP_MUTANT), and which ones a run comes by: one byte each of the file
   SGMP_MUTANT_TRACE, mapped into memory, so that processes that are killed have told, too. A run comes by the fault of
   a condition where that has another value than the right one: until then nothing is different. */
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

enum { most = 65536 };

static int active = 0;
static unsigned char *reached = NULL;

__attribute__((constructor)) static void mutant_start(void)
{
  const char *number = getenv("SGMP_MUTANT"), *trace = getenv("SGMP_MUTANT_TRACE");
  if (number) active = atoi(number);
  if (!trace) return;
  const int file = open(trace, O_RDWR | O_CREAT, 0600);
  if (file < 0 || ftruncate(file, most) != 0) abort();
  reached = mmap(NULL, most, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (reached == MAP_FAILED) abort();
  close(file);
}

_Bool mutant_on(int number)
{
  if (reached) reached[number] = 1;
  return number == active;
}

_Bool mutant_either(int number, _Bool now, _Bool was)
{
  if (reached && now != was) reached[number] = 1;
  return number == active ? now : was;
}
