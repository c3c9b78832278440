/* sensor/settings/band_choice.c: sensor.bands as a set of bands, with further channels chosen in their places. */
#include "sensor/settings/band_choice.h"

#include "pitviper_channels.h"
#include "render/scene/view.h"

/* A band by its own name: optical, mwir, lwir, radar; -1: none. */
static int band_named(const char *name, size_t length)
{
    static const char *const names[BAND_COUNT] = {"optical", "mwir", "lwir", "radar"};
    for (int b = 0; b < BAND_COUNT; b++)
        if (strlen(names[b]) == length && strncmp(names[b], name, length) == 0) return b;
    return -1;
}

static bool no_bands(const char *text)
{
    char further[256];
    channels_list(further, sizeof further);
    log_error("config: sensor.bands: '%s' is not a list of optical, radar or channels of etc/channels.csv: %s", text,
              further);
    return false;
}

bool bands_choose(unsigned *bands, const char *text)
{
    *bands = 0;
    if (channels_load() != STATUS_OK) return false;
    channels_standard();
    for (const char *at = text; *at;) {
        const size_t           length = strcspn(at, ",");
        const SpectralChannel *channel = channel_named(at, length);
        int                    found = band_named(at, length);
        if (channel && !channel->standard) {
            found = channel->place == SPECTRAL_NIR    ? BAND_OPTICAL
                    : channel->place == SPECTRAL_MWIR ? BAND_MWIR
                                                      : BAND_LWIR;
            if (*bands >> found & 1) {
                log_error("config: sensor.bands: '%s': %s takes the place of another that is named; one of them a run",
                          text, channel->name);
                return false;
            }
            channel_choose(channel);
        } else if (found >= 0 && *bands >> found & 1 && strcmp(band_name((Band)found), "radar") != 0 &&
                   band_named(band_name((Band)found), strlen(band_name((Band)found))) < 0) {
            log_error("config: sensor.bands: '%s': %s takes the place of another that is named; one of them a run",
                      text, band_name((Band)found));
            return false;
        }
        if (found < 0) return no_bands(text);
        *bands |= 1u << found;
        at += length + (at[length] == ',');
    }
    if (*bands == 0) log_error("config: sensor.bands: no band is named; any of optical, mwir, lwir, radar");
    return *bands != 0;
}
