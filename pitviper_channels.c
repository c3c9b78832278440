/* pitviper_channels.c: reads etc/channels.csv once; maps channels to array indices. */
#include "pitviper_channels.h"
#include "pitviper_table.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const standard_names[SPECTRAL_PLACES] = {"b", "g", "r", "pan", "nir", "mwir", "lwir"};

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

/* A row as it is in the file. */
typedef struct Row {
    SpectralChannel c;
    const char     *low_um, *high_um, *response;
} Row;

static const char *parse_name(void *out, const char *text)
{
    const size_t length = strlen(text);
    if (length == 0 || length >= sizeof((SpectralChannel *)0)->name ||
        strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_") != length)
        return "a name of 1 to 15 of a-z, 0-9 and _";
    memcpy(out, text, length + 1);
    return NULL;
}

static const TableColumn columns[] = {
    {"name", TABLE_OWN, TABLE_AT(Row, c.name), .parse = parse_name},
    {"low_um", .type = TABLE_CELL, TABLE_AT(Row, low_um)},
    {"high_um", .type = TABLE_CELL, TABLE_AT(Row, high_um)},
    {"kind", TABLE_CHOICE, TABLE_AT(Row, c.kind), .choices = "reflective, emissive, both"},
    {"place", TABLE_CHOICE, TABLE_AT(Row, c.place), .choices = "b, g, r, pan, nir, mwir, lwir"},
    {"response", .type = TABLE_CELL, TABLE_AT(Row, response), .absent = TABLE_OPTIONAL},
};
static const TableFormat format = {"channels", columns, 6, .next = "etc/channels.csv explains the columns",
                                   .most_rows = channels_most};

/* Reads the response that a row names, a file beside the table, and checks that the edges are its ends. */
static Status open_response(SpectralChannel *c, const char *name, const TableRows *rows, int row)
{
    char              path[4096];
    SpectralResponse *response = NULL;
    const char       *table_path = rows->table.path, *slash = strrchr(table_path, '/');
    const size_t      length = strlen(name);
    if (c->standard)
        return table_rows_refuse(rows, row, NULL,
                                 "%s is a standard channel, which sees all between its edges alike: a response needs a "
                                 "further channel in its place",
                                 c->name);
    if (strchr(name, '/') || length < 5 || strcmp(name + length - 4, ".csv") != 0)
        return table_rows_refuse(rows, row, "response", "the name of a file NAME.csv in the folder of this table");
    const int folder = slash ? (int)(slash + 1 - table_path) : 0;
    if (snprintf(path, sizeof path, "%.*s%s", folder, table_path, name) >= (int)sizeof path)
        return table_rows_refuse(rows, row, "response", "a shorter path");
    const Status status = response_open(&response, path);
    if (status != STATUS_OK) return status;
    c->response = response;
    const double first_m = response->at_m[0], last_m = response->at_m[response->points - 1];
    if (fabs(first_m / c->low_m - 1) <= 1e-9 && fabs(last_m / c->high_m - 1) <= 1e-9) return STATUS_OK;
    return table_rows_refuse(rows, row, NULL, "%s goes from %g to %g um, which must be low_um and high_um", name,
                             1e6 * first_m, 1e6 * last_m);
}

static Status take_channel(void *user, const void *read, const TableRows *rows, int row)
{
    ChannelList    *list = user;
    const Row      *r = read;
    SpectralChannel c = r->c;
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->channel[i].name, c.name) == 0)
            return table_rows_refuse(rows, row, NULL, "a second row of name %s", c.name);
    if (!edge_of(&c.low_m, r->low_um) || !edge_of(&c.high_m, r->high_um) || !(c.low_m < c.high_m))
        return table_rows_refuse(rows, row, "low_um", "below high_um, both 0.3 to 30");
    snprintf(c.edges_um, sizeof c.edges_um, "%.12s-%.12s", r->low_um, r->high_um);
    c.standard = strcmp(c.name, standard_names[c.place]) == 0;
    if (!c.standard && place_of(c.name) < SPECTRAL_PLACES)
        return table_rows_refuse(rows, row, "place", "that of the standard channel %s", c.name);
    if (!c.standard && c.place < SPECTRAL_NIR) return table_rows_refuse(rows, row, "place", "nir, mwir or lwir");
    if (c.kind != (c.place < SPECTRAL_MWIR    ? SPECTRAL_REFLECTIVE
                   : c.place == SPECTRAL_MWIR ? SPECTRAL_BOTH
                                              : SPECTRAL_EMISSIVE))
        return table_rows_refuse(rows, row, "kind", "reflective of nir's place, both of mwir's, emissive of lwir's");
    const Status status = *r->response ? open_response(&c, r->response, rows, row) : STATUS_OK;
    list->channel[list->count++] = c; /* its response is closed with the list */
    return status;
}

static Status read_list(ChannelList *list, const char *path)
{
    Row          row;
    bool         has[SPECTRAL_PLACES] = {false};
    const Status status = table_each(&format, path, &row, sizeof row, take_channel, list);
    for (int i = 0; i < list->count; i++) has[list->channel[i].place] |= list->channel[i].standard;
    for (int p = 0; p < SPECTRAL_PLACES && status == STATUS_OK; p++) {
        if (has[p]) continue;
        log_error("channels: %s: no row of %s; %s", path, standard_names[p], format.next);
        return STATUS_BAD_VALUE;
    }
    return status;
}

static void close_responses(ChannelList *list)
{
    for (int i = 0; i < list->count; i++) {
        response_close((SpectralResponse *)list->channel[i].response);
        list->channel[i].response = NULL;
    }
}

Status channels_check(const char *path)
{
    ChannelList  list = {0};
    const Status status = read_list(&list, path);
    close_responses(&list);
    return status;
}

static void load(void)
{
    static const SpectralChannel none = {.name = "", .low_m = 1e-6, .high_m = 2e-6};
    char                         path[4096];
    for (int p = 0; p < SPECTRAL_PLACES; p++) table.in[p] = &none;
    table.status = etc_path(path, sizeof path, "channels.csv") ? read_list(&table.list, path) : STATUS_BAD_VALUE;
    if (table.status == STATUS_NO_MEMORY) log_error("channels: %s: out of memory", path);
    if (table.status != STATUS_OK) close_responses(&table.list);
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

SpectralBand channel_band(ChannelPlace place)
{
    const SpectralChannel *c = channel_in(place);
    return (SpectralBand){c->low_m, c->high_m, c->response};
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
