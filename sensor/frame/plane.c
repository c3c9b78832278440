/* sensor/frame/plane.c: the hash of a frame: names, sizes and values of its planes. */
#include "sensor/frame/plane.h"

/* Values are hashed in their memory representation. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "planes are hashed little-endian");

static const uint32_t nan_f32 = 0x7fc00000u;
static const uint64_t nan_f64 = 0x7ff8000000000000u;

enum { chunk_values = 4096 };

static bool update_f32(Sha256 *digest, const float *values, size_t count)
{
    uint32_t chunk[chunk_values];
    for (size_t first = 0; first < count; first += chunk_values) {
        const size_t n = count - first < chunk_values ? count - first : chunk_values;
        memcpy(chunk, values + first, n * sizeof *chunk);
        for (size_t i = 0; i < n; i++) chunk[i] = (chunk[i] & 0x7fffffffu) > 0x7f800000u ? nan_f32 : chunk[i];
        if (!sha256_add(digest, chunk, n * sizeof *chunk)) return false;
    }
    return true;
}

static bool update_f64(Sha256 *digest, const double *values, size_t count)
{
    uint64_t chunk[chunk_values];
    for (size_t first = 0; first < count; first += chunk_values) {
        const size_t n = count - first < chunk_values ? count - first : chunk_values;
        memcpy(chunk, values + first, n * sizeof *chunk);
        for (size_t i = 0; i < n; i++)
            chunk[i] = (chunk[i] & 0x7fffffffffffffffu) > 0x7ff0000000000000u ? nan_f64 : chunk[i];
        if (!sha256_add(digest, chunk, n * sizeof *chunk)) return false;
    }
    return true;
}

static bool update_plane(Sha256 *digest, const Plane *plane)
{
    static const char tag[][4] = {
        [PLANE_F32] = "f32", [PLANE_U32] = "u32", [PLANE_F64] = "f64", [PLANE_C64] = "c64", [PLANE_U8] = "u8"};
    const uint32_t size[2] = {(uint32_t)plane->width, (uint32_t)plane->height};
    const size_t   count = (size_t)plane->width * (size_t)plane->height;

    if (!sha256_add(digest, plane->name, strlen(plane->name) + 1)) return false;
    if (!sha256_add(digest, size, sizeof size)) return false;
    if (!sha256_add(digest, tag[plane->type], sizeof tag[0])) return false;
    switch (plane->type) {
    case PLANE_F32:
        return update_f32(digest, plane->values, count);
    case PLANE_F64:
        return update_f64(digest, plane->values, count);
    case PLANE_C64:
        return update_f32(digest, plane->values, 2 * count);
    case PLANE_U8:
        return sha256_add(digest, plane->values, count);
    case PLANE_U32:
        break;
    }
    return sha256_add(digest, plane->values, count * sizeof(uint32_t));
}

Status plane_hash(char out[sha256_text_size], const Plane *plane, int plane_count)
{
    int order[plane_hash_max_planes];

    if (plane_count < 0 || plane_count > plane_hash_max_planes) return STATUS_BAD_VALUE;
    for (int i = 0; i < plane_count; i++) {
        if (!plane[i].name || !plane[i].name[0] || plane[i].width < 1 || plane[i].height < 1) return STATUS_BAD_VALUE;
        int at = i;
        for (; at > 0 && strcmp(plane[order[at - 1]].name, plane[i].name) >= 0; at--) {
            if (strcmp(plane[order[at - 1]].name, plane[i].name) == 0) return STATUS_BAD_VALUE;
            order[at] = order[at - 1];
        }
        order[at] = i;
    }

    Sha256 *digest = sha256_begin();
    if (!digest) return STATUS_NO_MEMORY;
    bool ok = true;
    for (int i = 0; i < plane_count && ok; i++) ok = update_plane(digest, &plane[order[i]]);
    return sha256_end(out, digest, ok);
}
