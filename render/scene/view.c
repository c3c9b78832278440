/* render/scene/view.c: the names of bands. */
#include "render/scene/view.h"

#include "pitviper_channels.h"

/* A channel in another's place gives the band its own name. */
static const char *name_in(ChannelPlace place, const char *standard)
{
    return channel_in(place)->standard || !*channel_in(place)->name ? standard : channel_in(place)->name;
}

const char *band_name(Band band)
{
    switch (band) {
    case BAND_OPTICAL: return name_in(SPECTRAL_NIR, "optical");
    case BAND_MWIR:    return name_in(SPECTRAL_MWIR, "mwir");
    case BAND_LWIR:    return name_in(SPECTRAL_LWIR, "lwir");
    case BAND_RADAR:   return "radar";
    case BAND_COUNT:   break;
    }
    return "unknown";
}
