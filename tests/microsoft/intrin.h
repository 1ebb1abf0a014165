/* What of Microsoft's intrin.h the headers use, for platforms.sh */
#ifndef MICROSOFT_INTRIN_H
#define MICROSOFT_INTRIN_H

#ifdef __cplusplus
extern "C" {
#endif
unsigned __int64 _umul128(unsigned __int64 x, unsigned __int64 y, unsigned __int64 *high);
unsigned __int64 __umulh(unsigned __int64 x, unsigned __int64 y);
#ifdef __cplusplus
}
#endif

#endif
