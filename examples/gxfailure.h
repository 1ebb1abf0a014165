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

/* What a Boolean's result says of its surfaces */
static inline const char *gxfailure_of_surfaces(gx_result result) {
    switch (result) {
    case GX_ERROR_MEMORY: return "out of memory";
    case GX_ERROR_NOT_FINITE: return "a coordinate is not finite";
    case GX_ERROR_RANGE: return "a number is too large or too small";
    case GX_ERROR_EMPTY: return "there are no triangles";
    case GX_ERROR_NOT_CLOSED: return "the surface is not closed, or its triangles are not oriented alike";
    case GX_ERROR_LIMIT: return "there are too many triangles";
    default: return "the kernel failed";
    }
}

#endif /* GXFAILURE_H */
