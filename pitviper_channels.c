/* pitviper_channels.c: reads etc/channels.csv once; maps channels to array indices. */
#include "pitviper_channels.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const standard_names[SPECTRAL_PLACES] = {"b", "g", "r", "pan", "nir", "mwir", "lwir"};
static const char *const kind_names[] = {"reflective", "emissive", "both"};

typedef struct ChannelList {
    int             count;
    SpectralChannel channel[channels_most];
} ChannelList;

static struct {
    pthread_once_t         once;
    Status                 status;
    ChannelList            list;
    const SpectralChannel *in[SPECTRAL_PLACES];
} table = {.once = PTHREAD_ONCE_INIT};

static int place_of(const char *name)
{
    int place = 0;
    while (place < SPECTRAL_PLACES && strcmp(standard_names[place], name) != 0) place++;
    return place;
}

/* An edge as it is written, in um: 0.4 is 0.4e-6 to the last bit. */
static bool edge_of(double *edge_m, const char *um)
{
    char text[32];
    return strlen(um) < 16 && snprintf(text, sizeof text, "%se-6", um) > 0 && text_to_double(edge_m, text) &&
           *edge_m >= 0.3e-6 && *edge_m <= 30e-6;
}

/* What is wrong with a row; NULL: nothing. */
static const char *read_channel(ChannelList *list, const Table *t, int row, const int column[5])
{
    const char     *text[5];
    SpectralChannel c = {0};
    for (int k = 0; k < 5; k++) text[k] = table_text(t, row, column[k]);
    const size_t length = strlen(text[0]);
    for (size_t i = 0; i < length; i++)
        if (!strchr("abcdefghijklmnopqrstuvwxyz0123456789_", text[0][i])) return "name: a-z, 0-9 and _ alone";
    if (length == 0 || length >= sizeof c.name) return "name: 1 to 15 characters";
    memcpy(c.name, text[0], length + 1);
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->channel[i].name, c.name) == 0) return "a second row of this name";
    if (!edge_of(&c.low_m, text[1]) || !edge_of(&c.high_m, text[2]) || !(c.low_m < c.high_m))
        return "low_um below high_um, both 0.3 to 30";
    snprintf(c.edges_um, sizeof c.edges_um, "%.12s-%.12s", text[1], text[2]);
    int kind = 0;
    while (kind < 3 && strcmp(kind_names[kind], text[3]) != 0) kind++;
    if (kind == 3) return "kind: reflective, emissive or both";
    c.kind = (ChannelKind)kind;
    const int place = place_of(text[4]);
    if (place == SPECTRAL_PLACES) return "place: b, g, r, pan, nir, mwir or lwir";
    c.place = (ChannelPlace)place;
    c.standard = strcmp(c.name, text[4]) == 0;
    if (!c.standard && place_of(c.name) < SPECTRAL_PLACES) return "a standard channel has its own place";
    if (!c.standard && place < SPECTRAL_NIR) return "place: nir, mwir or lwir";
    if (kind != (place < SPECTRAL_MWIR    ? SPECTRAL_REFLECTIVE
                 : place == SPECTRAL_MWIR ? SPECTRAL_BOTH
                                          : SPECTRAL_EMISSIVE))
        return "kind: nir's place is reflective, mwir's both, lwir's emissive";
    list->channel[list->count++] = c;
    return NULL;
}

static Status read_list(ChannelList *list, const char *path)
{
    static const char *const columns[5] = {"name", "low_um", "high_um", "kind", "place"};
    Table                    t = {0};
    int                      column[5];
    Status                   status = table_open(&t, path);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < 5; k++)
        if ((column[k] = table_column(&t, columns[k])) < 0) {
            log_error("channels: %s:%d: column missing: %s", path, t.line[0], columns[k]);
            status = STATUS_BAD_VALUE;
        }
    if (status == STATUS_OK && t.rows > channels_most) {
        log_error("channels: %s: %d rows, of at most %d", path, t.rows, (int)channels_most);
        status = STATUS_BAD_VALUE;
    }
    for (int row = 0; row < t.rows && status == STATUS_OK; row++) {
        const char *wrong = read_channel(list, &t, row, column);
        if (!wrong) continue;
        log_error("channels: %s:%d: %s: %s", path, t.line[row + 1], table_text(&t, row, column[0]), wrong);
        status = STATUS_BAD_VALUE;
    }
    table_close(&t);
    bool has[SPECTRAL_PLACES] = {false};
    for (int i = 0; i < list->count; i++) has[list->channel[i].place] |= list->channel[i].standard;
    for (int p = 0; p < SPECTRAL_PLACES && status == STATUS_OK; p++) {
        if (has[p]) continue;
        log_error("channels: %s: no row of %s", path, standard_names[p]);
        status = STATUS_BAD_VALUE;
    }
    return status;
}

Status channels_check(const char *path)
{
    ChannelList list = {0};
    return read_list(&list, path);
}

static void load(void)
{
    static const SpectralChannel none = {.name = "", .low_m = 1e-6, .high_m = 2e-6};
    char                         path[4096];
    for (int p = 0; p < SPECTRAL_PLACES; p++) table.in[p] = &none;
    table.status = etc_path(path, sizeof path, "channels.csv") ? read_list(&table.list, path) : STATUS_BAD_VALUE;
    if (table.status == STATUS_NO_MEMORY) log_error("channels: %s: out of memory", path);
    for (int i = 0; i < table.list.count && table.status == STATUS_OK; i++)
        if (table.list.channel[i].standard) table.in[table.list.channel[i].place] = &table.list.channel[i];
}

Status channels_load(void)
{
    pthread_once(&table.once, load);
    return table.status;
}

const SpectralChannel *channel_in(ChannelPlace place)
{
    channels_load();
    return table.in[place];
}

const SpectralChannel *channel_named(const char *name, size_t length)
{
    if (channels_load() != STATUS_OK) return NULL;
    for (int i = 0; i < table.list.count; i++)
        if (strlen(table.list.channel[i].name) == length && memcmp(table.list.channel[i].name, name, length) == 0)
            return &table.list.channel[i];
    return NULL;
}

void channels_standard(void)
{
    if (channels_load() != STATUS_OK) return;
    for (int i = 0; i < table.list.count; i++)
        if (table.list.channel[i].standard) table.in[table.list.channel[i].place] = &table.list.channel[i];
}

void channel_choose(const SpectralChannel *channel) { table.in[channel->place] = channel; }

void channels_list(char *out, size_t out_size)
{
    size_t n = 0;
    *out = 0;
    if (channels_load() != STATUS_OK) return;
    for (int i = 0; i < table.list.count; i++) {
        if (table.list.channel[i].standard && table.list.channel[i].place < SPECTRAL_MWIR) continue;
        const int added = snprintf(out + n, out_size - n, "%s%s", n ? ", " : "", table.list.channel[i].name);
        if (added < 0 || n + (size_t)added >= out_size) return;
        n += (size_t)added;
    }
}
