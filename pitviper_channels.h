/* pitviper_channels.h: the table of channels, etc/channels.csv: each sensor band and its quantity.
 *
 * Arrays by channel have a place for each of the standard ones and loops over them a bound that the compiler knows. A
 * further channel takes one of these places (place) for a run: channel_choose, before tables are read. So everything
 * indexed by place (light, air, materials, smoke, images, truth, detectors, files) follows the channel. */
#ifndef PITVIPER_CHANNELS_H
#define PITVIPER_CHANNELS_H

#include "pitviper_response.h"

/* Places, named after the standard channel of each. */
typedef enum ChannelPlace {
    SPECTRAL_B,
    SPECTRAL_G,
    SPECTRAL_R,
    SPECTRAL_PAN,
    SPECTRAL_NIR,
    SPECTRAL_MWIR,
    SPECTRAL_LWIR,
    SPECTRAL_PLACES
} ChannelPlace;

typedef enum ChannelKind { SPECTRAL_REFLECTIVE, SPECTRAL_EMISSIVE, SPECTRAL_BOTH } ChannelKind;

enum { channel_name_size = 16, channels_most = 64 };

typedef struct SpectralChannel {
    char         name[channel_name_size]; /* a-z, 0-9 and _ */
    char         edges_um[32];            /* "0.7-1.1" */
    double       low_m, high_m;
    ChannelKind  kind;
    ChannelPlace place;
    bool         standard; /* it has its place when no other channel is chosen */
    /* NULL: all wavelengths between the edges alike, as those of the standard channels */
    const SpectralResponse *response;
} SpectralChannel;

/* Reads the table once, at the first call. Later calls return the same status; failures are logged with file and
 * line. */
Status channels_load(void);
/* Checks any file in the same way; its rows are not used. */
Status channels_check(const char *path);
/* The channel in a place; of a table that cannot be read a channel without a name. */
const SpectralChannel *channel_in(ChannelPlace place);
/* Edges and response of the channel in a place. */
SpectralBand channel_band(ChannelPlace place);
/* NULL: no such channel. */
const SpectralChannel *channel_named(const char *name, size_t length);
/* Every standard channel in its place; then another one into its own. Before tables are read, by one thread. */
void channels_standard(void);
void channel_choose(const SpectralChannel *channel);
/* Names of those that can be chosen, separated by commas. */
void channels_list(char *out, size_t out_size);

#endif
