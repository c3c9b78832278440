/* terrain/elevation/vector_set.c: files with vectors as the program has them: asked of the process that reads them, and
 * checked. */
#include "terrain/elevation/vector.h"

#include "terrain/elevation/raster.h"
#include "terrain/elevation/raster_child.h"

#include <limits.h>
#include <stdlib.h>
#include <unistd.h>

_Static_assert((int)vector_most_tags == (int)wire_most_tags && (int)vector_most_corners == (int)wire_most_corners &&
                   (int)vector_most_rings == (int)wire_most_rings,
               "what a part may hold");

static void begin(WireChannel *channel, WireAsk ask, const char *key)
{
    channel->request = (WireRequest){.ask = ask};
    snprintf(channel->request.key, sizeof channel->request.key, "%s", key);
}

static Status answer(RasterChild *child, WireChannel *channel, WireReply *reply)
{
    const Status status = raster_child_ask(child, channel, reply);
    return status == STATUS_OK ? (Status)reply->status : status;
}

Status vectors_open(Vectors *out, const char *files, const char *key)
{
    char        here[PATH_MAX];
    const char *texts[] = {getcwd(here, sizeof here) ? here : "", files, raster_within(), raster_sources()};
    Vectors     vectors = {0};
    WireReply   reply;
    size_t      used = 0;
    Status      status = raster_child_start(&vectors.child, key);
    if (status != STATUS_OK) return status;
    WireChannel *channel = raster_child_take(vectors.child);
    begin(channel, WIRE_VECTORS, key);
    for (size_t k = 0; k < sizeof texts / sizeof *texts && status == STATUS_OK; k++) {
        const size_t octets = strlen(texts[k]) + 1;
        if (octets > wire_data_octets - used) status = STATUS_BAD_VALUE;
        else memcpy(channel->data + used, texts[k], octets);
        used += octets;
    }
    if (status != STATUS_OK) log_error("%s: the names of the files are too long; put their features into one", key);
    else status = answer(vectors.child, channel, &reply);
    if (status == STATUS_OK) {
        WireVectors w;
        memcpy(&w, channel->data, sizeof w);
        memcpy(vectors.box_deg, w.box.deg, sizeof vectors.box_deg);
        for (int k = 0; k < 4; k++)
            if (!(fabs(w.box.deg[k]) <= (k % 2 ? 90 : 1e4))) vectors.box_deg[k] = NAN;
        vectors.files = w.files, vectors.layers = w.layers;
        if (w.files < 1 || w.layers < 0) status = raster_child_distrust(vectors.child, channel);
    }
    raster_child_give(vectors.child, channel);
    if (status == STATUS_OK) *out = vectors;
    else vectors_close(&vectors);
    return status;
}

void vectors_close(Vectors *vectors)
{
    raster_child_stop(vectors->child);
    *vectors = (Vectors){0};
}

/* ---- replies ---------------------------------------------------------------------------------------- */

/* The text at *at of `octets` of texts, and *at behind it; NULL: it does not end there. */
static const char *next_text(size_t *at, const char *texts, size_t octets)
{
    const char *text = texts + *at, *end = memchr(text, 0, octets - *at);
    if (!end) return NULL;
    *at += (size_t)(end - text) + 1;
    return text;
}

static bool rings_are_whole(const WireFeature *w, const int32_t *ring)
{
    int64_t corners = 0;
    for (int k = 0; k < w->rings; k++) {
        if (ring[k] < 3 || ring[k] > wire_most_corners) return false;
        corners += ring[k];
    }
    return corners == w->ring_corners && (w->rings == 0 || w->shape == WIRE_POLYGON);
}

bool vector_part_read(VectorPart *out, size_t *at, const uint8_t *data, size_t octets)
{
    WireFeature w;
    size_t      used = 0;
    if (*at > octets || *at % 8 != 0 || octets - *at < sizeof w) return false;
    memcpy(&w, data + *at, sizeof w);
    if (w.octets > octets - *at || w.octets % 8 != 0 || w.shape < WIRE_POINT || w.shape > WIRE_POLYGON ||
        w.corners < 0 || w.corners > wire_most_corners || w.holes < 0 || w.tags < 0 || w.tags > wire_most_tags ||
        w.texts < 0 || w.texts > wire_most_texts || w.file < 0 || w.part < 0 || w.number < 0 || w.rings < 0 ||
        w.rings > wire_most_rings || w.ring_corners < 0 || w.ring_corners > wire_most_corners)
        return false;
    if ((w.shape == WIRE_POINT && w.corners != 1) || (w.shape == WIRE_LINE && w.corners < 2)) return false;
    const size_t own = 2 * sizeof(double) * (size_t)w.corners, inner = 2 * sizeof(double) * (size_t)w.ring_corners;
    const size_t sizes = ((size_t)w.rings * sizeof(int32_t) + 7) / 8 * 8, places = own + inner + sizes;
    if (w.octets != sizeof w + places + ((size_t)w.texts + 7) / 8 * 8) return false;
    const uint8_t *rings = data + *at + sizeof w + own;
    if (!rings_are_whole(&w, (const int32_t *)(const void *)(rings + inner))) return false;
    const char *texts = (const char *)data + *at + sizeof w + places;
    *out = (VectorPart){.shape = (VectorShape)w.shape,
                        .corners = w.corners,
                        .lon_lat_rad = (const double(*)[2])(const void *)(data + *at + sizeof w),
                        .holes = w.holes,
                        .rings = w.rings,
                        .ring = (const int32_t *)(const void *)(rings + inner),
                        .ring_lon_lat_rad = (const double(*)[2])(const void *)rings,
                        .file = w.file,
                        .part = w.part,
                        .number = w.number,
                        .tags = w.tags};
    for (int k = 0; k < w.tags; k++) {
        out->name[k] = next_text(&used, texts, (size_t)w.texts);
        out->value[k] = out->name[k] ? next_text(&used, texts, (size_t)w.texts) : NULL;
        if (!out->value[k]) return false;
    }
    *at += w.octets;
    return used == (size_t)w.texts;
}

static bool take_end(VectorEnd *out, const uint8_t *data)
{
    WireEnd w;
    memcpy(&w, data, sizeof w);
    *out = (VectorEnd){w.features, w.outside, w.shapeless};
    return w.features >= 0 && w.outside >= 0 && w.shapeless >= 0;
}

Status vectors_each(VectorEnd *end, Vectors *vectors, const double box_deg[4], VectorTake *take, void *user,
                    const char *key)
{
    static const double most_octets = 64e9;
    uint8_t            *data = malloc(wire_data_octets); /* a copy: the reader could change what it shares */
    Status              status = data ? STATUS_OK : STATUS_NO_MEMORY;
    int64_t             parts = 0;
    double              octets = 0; /* of all replies */
    bool                over = false, filled = true;
    WireChannel        *channel = raster_child_take(vectors->child);
    while (status == STATUS_OK && !over) {
        WireReply  reply;
        VectorPart part;
        size_t     at = 0;
        begin(channel, WIRE_FEATURES, key);
        memcpy(channel->data, box_deg, sizeof(WireBox));
        status = answer(vectors->child, channel, &reply);
        if (status != STATUS_OK) break;
        memcpy(data, channel->data, wire_data_octets);
        over = reply.count == 0;
        /* a reader sends as much at once as fits, but for the last time */
        if (reply.count < 0 || (over && !take_end(end, data)) || (!over && !filled))
            status = raster_child_distrust(vectors->child, channel);
        for (int n = 0; n < reply.count && status == STATUS_OK; n++) {
            if (!vector_part_read(&part, &at, data, wire_data_octets))
                status = raster_child_distrust(vectors->child, channel);
            else status = take(user, &part);
        }
        filled = at >= wire_data_octets / 2;
        octets += (double)at, parts += reply.count;
        if (status == STATUS_OK && (parts > vector_most_parts || octets > most_octets)) {
            log_error(
                "%s: more than %d points, lines and polygons, or than %.0f GB of them; cut out an area: ogr2ogr -spat "
                "WEST SOUTH EAST NORTH OUT.gpkg FILE",
                key, (int)vector_most_parts, 1e-9 * most_octets);
            status = STATUS_BAD_VALUE;
        }
    }
    raster_child_give(vectors->child, channel);
    free(data);
    return status;
}
