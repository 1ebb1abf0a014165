/* csv.h - tables of the benches. Rows go to stdout and, if there is one, to a file. The file has ".part" at the end
   of its name until the table is whole. Define _POSIX_C_SOURCE before the first header. */
#ifndef BENCH_CSV_H
#define BENCH_CSV_H

#include "progress.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static FILE *csv_file; /* NULL: stdout only */
static char csv_path[4096];
static int csv_to_file_only;

static inline void csv_part(char path[sizeof csv_path + 8]) {
    snprintf(path, sizeof csv_path + 8, "%s.part", csv_path);
}

static inline void csv_row(const char *format, ...) {
    FILE *to[2];
    int i;
    to[0] = csv_to_file_only ? NULL : stdout;
    to[1] = csv_file;
    progress_clear();
    for (i = 0; i < 2; i++) {
        va_list values;
        if (!to[i]) continue;
        va_start(values, format);
        vfprintf(to[i], format, values);
        va_end(values);
        fputc('\n', to[i]);
        fflush(to[i]);
    }
}

/* usage: program [FILE [--small]]; anything else ends the program. Returns the file's name; NULL: none */
static inline const char *csv_arguments(int argc, char **argv, int *small) {
    *small = argc > 2 && strcmp(argv[2], "--small") == 0;
    if (argc <= 2 + *small && (argc < 2 || argv[1][0] != '-')) return argc > 1 ? argv[1] : NULL;
    fprintf(stderr, "usage: %s [FILE [--small]]\n", argv[0]);
    exit(2);
}

/* path: NULL: stdout only */
static inline void csv_open(const char *program, const char *path, const char *header) {
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

/* A second table, which does not go to stdout */
static inline void csv_open_second(const char *program, const char *path, const char *header) {
    csv_to_file_only = 1;
    csv_open(program, path, header);
}

/* 1, with a message, if the file could not be written */
static inline int csv_close(void) {
    char part[sizeof csv_path + 8];
    if (!csv_file) return 0;
    csv_part(part);
    if (fclose(csv_file) == 0 && rename(part, csv_path) == 0) return 0;
    fprintf(stderr, "cannot write %s\n", csv_path);
    return 1;
}

#endif
