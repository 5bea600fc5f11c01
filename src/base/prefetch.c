/* Asks the processor to bring data into its cache before they are needed. */

#define LINE 64 /* bytes */

void sgmp_prefetch_lines(const char *data, int bytes)
{
#ifdef __GNUC__
    for (int offset = 0; offset < bytes; offset += LINE)
        __builtin_prefetch(data + offset, 1);
#else
    (void)data;
    (void)bytes;
#endif
}
