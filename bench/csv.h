/* Tables of the benches: each row to stdout and, where the program was given a file name, to that file. */
#ifndef BENCH_CSV_H
#define BENCH_CSV_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static FILE *csv_file; /* NULL: stdout only */

static void csv_row(const char *format, ...)
{
    FILE *to[2];
    int i;
    to[0] = stdout;
    to[1] = csv_file;
    for (i = 0; i < 2 && to[i]; ++i) {
        va_list values;
        va_start(values, format);
        vfprintf(to[i], format, values);
        va_end(values);
        fputc('\n', to[i]);
        fflush(to[i]);
    }
}

/* usage: program [FILE] */
static void csv_open(int argc, char **argv, const char *header)
{
    csv_file = argc > 1 ? fopen(argv[1], "w") : NULL;
    if (argc > 1 && !csv_file) {
        fprintf(stderr, "%s: cannot write %s\n", argv[0], argv[1]);
        exit(2);
    }
    csv_row("%s", header);
}

static int csv_close(void)
{
    return csv_file && fclose(csv_file) != 0;
}

#endif
