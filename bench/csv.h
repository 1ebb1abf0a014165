/* csv.h - tables of the benches. Rows go to stdout and, where the program was given a file's name, to that file, which has its name when the
   table is whole: until then ".part" is behind it. Define _POSIX_C_SOURCE before the first header. */
#ifndef BENCH_CSV_H
#define BENCH_CSV_H

#include "progress.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static FILE *csv_file; /* NULL: stdout only */
static char csv_path[4096];
static int csv_to_file_only;

static inline void csv_part(char path[sizeof csv_path + 8])
{
    snprintf(path, sizeof csv_path + 8, "%s.part", csv_path);
}

static inline void csv_row(const char *format, ...)
{
    FILE *to[2];
    int i;
    to[0] = csv_to_file_only ? NULL : stdout;
    to[1] = csv_file;
    progress_clear();
    for (i = 0; i < 2; ++i) {
        va_list values;
        if (!to[i]) continue;
        va_start(values, format);
        vfprintf(to[i], format, values);
        va_end(values);
        fputc('\n', to[i]);
        fflush(to[i]);
    }
}

/* path: NULL: stdout only */
static inline void csv_open_path(const char *program, const char *path, const char *header)
{
    char part[sizeof csv_path + 8];
    csv_file = NULL;
    if (path) {
        snprintf(csv_path, sizeof csv_path, "%s", path);
        csv_part(part);
        csv_file = fopen(part, "w");
        if (!csv_file) {
            fprintf(stderr, "%s: cannot write %s\n", program, part);
            exit(2);
        }
    }
    csv_row("%s", header);
}

/* usage: program [FILE] */
static inline void csv_open(int argc, char **argv, const char *header)
{
    csv_to_file_only = 0;
    csv_open_path(argv[0], argc > 1 ? argv[1] : NULL, header);
}

/* A second table, which stdout does not get */
static inline void csv_open_second(const char *program, const char *path, const char *header)
{
    csv_to_file_only = 1;
    csv_open_path(program, path, header);
}

/* 1, and says so, if the file could not be written */
static inline int csv_close(void)
{
    char part[sizeof csv_path + 8];
    if (!csv_file) return 0;
    csv_part(part);
    if (fclose(csv_file) == 0 && rename(part, csv_path) == 0) return 0;
    fprintf(stderr, "cannot write %s\n", csv_path);
    return 1;
}

#endif
