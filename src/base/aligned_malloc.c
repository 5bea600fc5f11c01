/* Arrays that Fortran allocates begin on a cache line: a vector of eight numbers that lies across two lines is read and
   written at half the speed. The linker calls this instead of malloc (CMakeLists.txt); small blocks stay where they are. */

#include <stdlib.h>

#define LINE 64   /* bytes */
#define SMALL 512 /* bytes */

void *__real_malloc(size_t size);

void *__wrap_malloc(size_t size)
{
    void *block = NULL;
    if (size < SMALL)
        return __real_malloc(size);
    return posix_memalign(&block, LINE, size) == 0 ? block : NULL;
}
