/* gxfailure.h: a gx_failure in words. Include a gxfem header before. */
#ifndef GXFAILURE_H
#define GXFAILURE_H

#include <stdio.h>

typedef struct gxfailure_text {
    char text[192];
} gxfailure_text;

/* "FIELD INDEX of surface SURFACE: cause", without what the failure does not name. cause: of the result, in words */
static inline gxfailure_text gxfailure_say(const gx_failure *failure, const char *cause) {
    const char *field = failure->field ? failure->field : "index";
    char surface[40] = "";
    gxfailure_text said;
    if (failure->surface != SIZE_MAX)
        snprintf(surface, sizeof surface, " of surface %lu", (unsigned long)failure->surface);
    if (failure->index != SIZE_MAX)
        snprintf(said.text, sizeof said.text, "%s %lu%s: %s", field, (unsigned long)failure->index, surface, cause);
    else if (failure->field)
        snprintf(said.text, sizeof said.text, "%s%s: %s", field, surface, cause);
    else
        snprintf(said.text, sizeof said.text, "%s", cause);
    return said;
}

#endif /* GXFAILURE_H */
