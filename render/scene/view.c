/* render/scene/view.c: the names of bands. */
#include "render/scene/view.h"

const char *band_name(Band band)
{
    switch (band) {
    case BAND_OPTICAL: return "optical";
    case BAND_MWIR:    return "mwir";
    case BAND_LWIR:    return "lwir";
    case BAND_RADAR:   return "radar";
    case BAND_COUNT:   break;
    }
    return "unknown";
}
