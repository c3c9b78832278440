/* sensor/publish/plane_hash.c: the hash of a frame: names, sizes and values of its planes. */
#include "sensor/publish/plane_hash.h"

#include <errno.h>
#include <openssl/evp.h>
#include <stdio.h>

/* Values are hashed as they lie in memory. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "planes are hashed little-endian");

static const uint32_t nan_f32 = 0x7fc00000u;
static const uint64_t nan_f64 = 0x7ff8000000000000u;

enum { chunk_values = 4096 };

static void to_text(char out[sha256_text_size], const unsigned char digest[32])
{
    static const char digit[] = "0123456789abcdef";
    for (int i = 0; i < 32; i++) {
        out[2 * i] = digit[digest[i] >> 4];
        out[2 * i + 1] = digit[digest[i] & 15];
    }
    out[64] = '\0';
}

/* Ends the digest and frees it. ok: whether every update so far went well. */
static Status finish(char out[sha256_text_size], EVP_MD_CTX *digest, bool ok)
{
    unsigned char sum[EVP_MAX_MD_SIZE];
    unsigned int  octets = 0;
    ok = ok && EVP_DigestFinal_ex(digest, sum, &octets) == 1 && octets == 32;
    EVP_MD_CTX_free(digest);
    if (!ok) return STATUS_NO_MEMORY;
    to_text(out, sum);
    return STATUS_OK;
}

static EVP_MD_CTX *begin(void)
{
    EVP_MD_CTX *digest = EVP_MD_CTX_new();
    if (digest && EVP_DigestInit_ex(digest, EVP_sha256(), NULL) == 1) return digest;
    EVP_MD_CTX_free(digest);
    return NULL;
}

static bool update_f32(EVP_MD_CTX *digest, const float *values, size_t count)
{
    uint32_t chunk[chunk_values];
    for (size_t first = 0; first < count; first += chunk_values) {
        const size_t n = count - first < chunk_values ? count - first : chunk_values;
        memcpy(chunk, values + first, n * sizeof *chunk);
        for (size_t i = 0; i < n; i++) chunk[i] = (chunk[i] & 0x7fffffffu) > 0x7f800000u ? nan_f32 : chunk[i];
        if (EVP_DigestUpdate(digest, chunk, n * sizeof *chunk) != 1) return false;
    }
    return true;
}

static bool update_f64(EVP_MD_CTX *digest, const double *values, size_t count)
{
    uint64_t chunk[chunk_values];
    for (size_t first = 0; first < count; first += chunk_values) {
        const size_t n = count - first < chunk_values ? count - first : chunk_values;
        memcpy(chunk, values + first, n * sizeof *chunk);
        for (size_t i = 0; i < n; i++)
            chunk[i] = (chunk[i] & 0x7fffffffffffffffu) > 0x7ff0000000000000u ? nan_f64 : chunk[i];
        if (EVP_DigestUpdate(digest, chunk, n * sizeof *chunk) != 1) return false;
    }
    return true;
}

static bool update_plane(EVP_MD_CTX *digest, const Plane *plane)
{
    static const char tag[][4] = {[PLANE_F32] = "f32", [PLANE_U32] = "u32", [PLANE_F64] = "f64",
                                  [PLANE_C64] = "c64"};
    const uint32_t size[2] = {(uint32_t)plane->width, (uint32_t)plane->height};
    const size_t   count = (size_t)plane->width * (size_t)plane->height;

    if (EVP_DigestUpdate(digest, plane->name, strlen(plane->name) + 1) != 1) return false;
    if (EVP_DigestUpdate(digest, size, sizeof size) != 1) return false;
    if (EVP_DigestUpdate(digest, tag[plane->type], sizeof tag[0]) != 1) return false;
    switch (plane->type) {
    case PLANE_F32: return update_f32(digest, plane->values, count);
    case PLANE_F64: return update_f64(digest, plane->values, count);
    case PLANE_C64: return update_f32(digest, plane->values, 2 * count);
    case PLANE_U32: break;
    }
    return EVP_DigestUpdate(digest, plane->values, count * sizeof(uint32_t)) == 1;
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

    EVP_MD_CTX *digest = begin();
    if (!digest) return STATUS_NO_MEMORY;
    bool ok = true;
    for (int i = 0; i < plane_count && ok; i++) ok = update_plane(digest, &plane[order[i]]);
    return finish(out, digest, ok);
}

Status sha256_bytes(char out[sha256_text_size], const void *bytes, size_t count)
{
    EVP_MD_CTX *digest = begin();
    if (!digest) return STATUS_NO_MEMORY;
    return finish(out, digest, count == 0 || EVP_DigestUpdate(digest, bytes, count) == 1);
}

Status sha256_file(char out[sha256_text_size], const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        log_error("hash: cannot read %s: %s", path, strerror(errno));
        return STATUS_IO;
    }
    EVP_MD_CTX *digest = begin();
    bool        ok = digest;
    char        chunk[65536];
    while (ok) {
        const size_t n = fread(chunk, 1, sizeof chunk, file);
        if (n == 0) break;
        ok = EVP_DigestUpdate(digest, chunk, n) == 1;
    }
    const int reason = ferror(file) ? errno : 0;
    fclose(file);
    if (reason) {
        log_error("hash: cannot read %s: %s", path, strerror(reason));
        EVP_MD_CTX_free(digest);
        return STATUS_IO;
    }
    return digest ? finish(out, digest, ok) : STATUS_NO_MEMORY;
}
