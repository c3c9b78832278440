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

static bool no_bands(const char *text, const char *band, size_t length, const char *where)
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
    log_error("config: %ssensor.bands: '%s' is not a list of optical, radar or channels of etc/channels.csv: %s; there is "
              "no '%s'%s", where, text, further, word, word_hint(&meant));
    return false;
}

/* Each band once: `lwir,lwir` is a slip. */
static bool named_once(const char *text, const char *where)
{
    for (const char *at = text; *at;) {
        const size_t length = strcspn(at, ",");
        for (const char *next = at + length; *next;) {
            next += *next == ',';
            const size_t other = strcspn(next, ",");
            if (other == length && length > 0 && strncmp(at, next, length) == 0) {
                log_error("config: %ssensor.bands: '%s': %.*s is named twice; name each band once", where, text,
                          (int)length, at);
                return false;
            }
            next += other;
        }
        at += length + (at[length] == ',');
    }
    return true;
}

static int band_of(const SpectralChannel *channel)
{
    return channel->place == SPECTRAL_NIR ? BAND_OPTICAL : channel->place == SPECTRAL_MWIR ? BAND_MWIR : BAND_LWIR;
}

/* where: of the setting in a file, for messages; or "". */
static bool parse(unsigned *bands, const SpectralChannel *further[BAND_COUNT], const char *text, const char *where)
{
    *bands = 0;
    if (channels_load() != STATUS_OK || !named_once(text, where)) return false;
    for (const char *at = text; *at;) {
        const size_t           length = strcspn(at, ",");
        const SpectralChannel *channel = channel_named(at, length);
        const bool             standard = !channel || channel->standard;
        const int              found = standard ? band_named(at, length) : band_of(channel);
        if (found < 0) return no_bands(text, at, length, where);
        if (*bands >> found & 1) {
            const SpectralChannel *one = standard ? further[found] : channel;
            log_error("config: %ssensor.bands: '%s': %s takes the place of another that is named; one of them a run",
                      where, text, one ? one->name : "it");
            return false;
        }
        if (!standard) further[found] = channel;
        *bands |= 1u << found;
        at += length + (at[length] == ',');
    }
    if (*bands == 0)
        log_error("config: %ssensor.bands: no band is named; any of optical, mwir, lwir, radar", where);
    return *bands != 0;
}

bool bands_check(const char *text, const char *where)
{
    const SpectralChannel *further[BAND_COUNT] = {NULL};
    unsigned               bands;
    return parse(&bands, further, text, where);
}

bool bands_choose(unsigned *bands, const char *text)
{
    const SpectralChannel *further[BAND_COUNT] = {NULL};
    if (!parse(bands, further, text, "")) return false;
    channels_standard();
    for (int b = 0; b < BAND_COUNT; b++)
        if (further[b]) channel_choose(further[b]);
    return true;
}
