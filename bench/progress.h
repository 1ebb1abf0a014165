/* progress.h - a progress bar on stderr, if that is a terminal. Define _POSIX_C_SOURCE before the first header. */
#ifndef BENCH_PROGRESS_H
#define BENCH_PROGRESS_H

#include <stdio.h>
#include <unistd.h>

static int progress_drawn; /* a bar stands on the terminal's last line */

/* Removes the bar, so that a line can be printed in its place. */
static inline void progress_clear(void) {
    if (!progress_drawn) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
    progress_drawn = 0;
}

static inline void progress_draw(const char *name, size_t done, size_t total, const char *at) {
    const size_t width = 40, filled = total ? width * done / total : width;
    size_t i;
    if (!isatty(2)) return;
    fprintf(stderr, "\r%s [", name);
    for (i = 0; i < width; i++) fputc(i < filled ? '#' : '.', stderr);
    fprintf(stderr, "] %lu/%lu %-24.24s", (unsigned long)done, (unsigned long)total, at);
    if (done == total) fprintf(stderr, "\n");
    fflush(stderr);
    progress_drawn = done != total;
}

#endif
