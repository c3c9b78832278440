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

static bool no_bands(const char *text, const char *band, size_t length)
{
    char further[256], word[64];
    snprintf(word, sizeof word, "%.*s", (int)length, band);
    WordMeant meant = word_meant(word);
    channels_list(further, sizeof further);
    word_consider_list(&meant, "optical|radar", '|');
    for (const char *at = further; *(at += strspn(at, ", "));) {
        char one[64];
        const size_t n = strcspn(at, ", ");
        snprintf(one, sizeof one, "%.*s", (int)n, at);
        word_consider(&meant, one);
        at += n;
    }
    log_error("config: sensor.bands: '%s': '%s' is not a band; a list of optical, radar or channels of "
              "etc/channels.csv: %s%s", text, word, further, word_hint(&meant));
    return false;
}

/* Each band once: `lwir,lwir` is a slip. */
static bool named_once(const char *text)
{
    for (const char *at = text; *at;) {
        const size_t length = strcspn(at, ",");
        for (const char *next = at + length; *next;) {
            next += *next == ',';
            const size_t other = strcspn(next, ",");
            if (other == length && length > 0 && strncmp(at, next, length) == 0) {
                log_error("config: sensor.bands: '%s': %.*s is named twice; name each band once", text, (int)length, at);
                return false;
            }
            next += other;
        }
        at += length + (at[length] == ',');
    }
    return true;
}

bool bands_choose(unsigned *bands, const char *text)
{
    *bands = 0;
    if (channels_load() != STATUS_OK) return false;
    channels_standard();
    if (!named_once(text)) return false;
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
        if (found < 0) return no_bands(text, at, length);
        *bands |= 1u << found;
        at += length + (at[length] == ',');
    }
    if (*bands == 0) log_error("config: sensor.bands: no band is named; any of optical, mwir, lwir, radar");
    return *bands != 0;
}
