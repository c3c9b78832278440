/* sensor/radar/signature_library.c: reads and writes signatures by the hash of all that they follow from. */
#include "sensor/radar/signature_library.h"
#include "pitviper_output.h"

#include "pitviper_file.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* Raise with every change of render/scattering that changes a bit of a signature. */
enum { computation = 1 };

enum { head_octets = 96, hash_octets = sha256_text_size - 1, most_centres = 1 << 22, models_known = 512 };
static const char magic[] = "PVSIGN1\n";

struct SignatureLibrary {
    Cache                   *cache; /* NULL: in the folder */
    char                     folder[3900];
    SignaturesConfig         config;
    char                     settings[sha256_text_size]; /* of config and materials */
    pthread_mutex_t          lock;                       /* protects the following */
    const Model             *model[models_known];
    char                     content[models_known][sha256_text_size];
    int                      models;
    bool                     told;
    SignatureLibraryCounters counters;
};

/* ---- octets ----------------------------------------------------------------------------------------- */

size_t signature_to_octets(uint8_t *out, const Signature *s, const char key[sha256_text_size])
{
    const size_t body = (size_t)s->count * sizeof *s->centre;
    char         sum[sha256_text_size];
    if (out) {
        const uint32_t counts[2] = {(uint32_t)s->count, 0};
        memcpy(out, magic, 8);
        memcpy(out + 8, key, hash_octets);
        memcpy(out + 8 + hash_octets, counts, sizeof counts);
        memcpy(out + 16 + hash_octets, &s->tubes_same_m2, 8);
        memcpy(out + 24 + hash_octets, &s->tubes_cross_m2, 8);
        if (body > 0) memcpy(out + head_octets, s->centre, body);
        if (sha256_bytes(sum, out, head_octets + body) != STATUS_OK) return 0;
        memcpy(out + head_octets + body, sum, hash_octets);
    }
    return head_octets + body + hash_octets;
}

Status signature_from_octets(Signature *out, const uint8_t *octets, size_t count, const char key[sha256_text_size],
                             int parts)
{
    uint32_t counts[2];
    char     sum[sha256_text_size];
    if (count < head_octets + hash_octets || memcmp(octets, magic, 8) != 0 || memcmp(octets + 8, key, hash_octets) != 0)
        return STATUS_BAD_VALUE;
    memcpy(counts, octets + 8 + hash_octets, sizeof counts);
    if (counts[0] > most_centres || counts[1] != 0) return STATUS_BAD_VALUE;
    const size_t body = counts[0] * sizeof *out->centre;
    if (count != head_octets + body + hash_octets) return STATUS_BAD_VALUE;
    if (sha256_bytes(sum, octets, head_octets + body) != STATUS_OK) return STATUS_NO_MEMORY;
    if (memcmp(sum, octets + head_octets + body, hash_octets) != 0) return STATUS_BAD_VALUE;
    SignatureCentre *centre = malloc(body + 1);
    if (!centre) return STATUS_NO_MEMORY;
    if (body > 0) memcpy(centre, octets + head_octets, body);
    Signature read = {.count = (int)counts[0], .centre = centre};
    memcpy(&read.tubes_same_m2, octets + 16 + hash_octets, 8);
    memcpy(&read.tubes_cross_m2, octets + 24 + hash_octets, 8);
    if (!signature_is_sound(&read, parts)) {
        free(centre);
        return STATUS_BAD_VALUE;
    }
    out->count = read.count;
    out->centre = centre;
    out->tubes_same_m2 = read.tubes_same_m2;
    out->tubes_cross_m2 = read.tubes_cross_m2;
    return STATUS_OK;
}

/* ---- what a signature is of ------------------------------------------------------------------------- */

static bool add_double(Sha256 *d, double x) { return sha256_add(d, &x, sizeof x); }
static bool add_int(Sha256 *d, int x) { return sha256_add(d, &x, sizeof x); }
static bool add_text(Sha256 *d, const char *text) { return sha256_add(d, text, strlen(text) + 1); }

static Status hash_settings(char out[sha256_text_size], const SignaturesConfig *c, const RadarMaterials *materials)
{
    const SignatureCells cells =
        signature_default_cells(c->frequency_hz, c->bandwidth_hz, c->aspect_rad, c->interval_s);
    const double numbers[] = {computation,
                              c->splits,
                              c->frequency_hz,
                              c->bandwidth_hz,
                              c->aspect_rad,
                              c->rays_per_wavelength,
                              c->warp_m,
                              cells.turn_rad,
                              cells.path_phase_rad,
                              cells.across_phase_rad,
                              cells.interval_s,
                              cells.spin_phase_rad,
                              cells.weak_share,
                              cells.weak_times};
    Sha256      *d = sha256_begin();
    bool         ok = d && sha256_add(d, numbers, sizeof numbers);
    for (int i = 0; i < materials->count && ok; i++) {
        const RadarMaterial *m = &materials->material[i];
        ok = add_text(d, m->name) && add_int(d, (int)m->kind) && add_double(d, m->thick_m) &&
             add_double(d, m->rough_m) && add_int(d, m->points);
        for (int p = 0; p < m->points && ok; p++)
            ok = add_double(d, m->frequency_hz[p]) && add_double(d, m->e1[p]) && add_double(d, m->e2[p]);
    }
    return sha256_end(out, d, ok);
}

static bool add_node(Sha256 *d, const ModelNode *n)
{
    bool ok = add_int(d, n->parent) && add_int(d, (int)n->joint) && add_double(d, n->low) && add_double(d, n->high) &&
              add_double(d, n->spin_rps_moving) && add_double(d, n->roll_radius_m) &&
              sha256_add(d, n->p_parent, sizeof n->p_parent) &&
              sha256_add(d, n->r_parent_from_node, sizeof n->r_parent_from_node);
    return ok && sha256_add(d, n->axis, sizeof n->axis);
}

static bool add_part(Sha256 *d, const ModelPart *p)
{
    bool ok = add_int(d, p->node) && add_text(d, p->material) && add_int(d, p->first_triangle) &&
              add_int(d, p->triangle_count) && add_int(d, p->damage_hidden);
    for (int state = 0; state < model_damage_states && ok; state++) ok = add_text(d, p->damage_material[state]);
    return ok;
}

static Status hash_model(char out[sha256_text_size], const Model *m)
{
    Sha256 *d = sha256_begin();
    bool    ok = d && add_text(d, m->name) && add_int(d, m->node_count) && add_int(d, m->part_count) &&
              add_int(d, m->vertex_count) && add_int(d, m->triangle_count);
    for (int i = 0; i < m->node_count && ok; i++) ok = add_node(d, &m->node[i]);
    for (int i = 0; i < m->part_count && ok; i++) ok = add_part(d, &m->part[i]);
    ok = ok && sha256_add(d, m->vertex, (size_t)m->vertex_count * sizeof *m->vertex) &&
         sha256_add(d, m->normal, (size_t)m->vertex_count * sizeof *m->normal) &&
         sha256_add(d, m->triangle, (size_t)m->triangle_count * sizeof *m->triangle) &&
         sha256_add(d, m->triangle_part, (size_t)m->triangle_count * sizeof *m->triangle_part);
    return sha256_end(out, d, ok);
}

/* A model of a catalog does not change: its hash is kept. */
static Status content_of(char out[sha256_text_size], SignatureLibrary *l, const Model *model)
{
    pthread_mutex_lock(&l->lock);
    int at = 0;
    while (at < l->models && l->model[at] != model) at++;
    const bool known = at < l->models;
    if (known) memcpy(out, l->content[at], sha256_text_size);
    pthread_mutex_unlock(&l->lock);
    if (known) return STATUS_OK;
    const Status status = hash_model(out, model);
    if (status != STATUS_OK) return status;
    pthread_mutex_lock(&l->lock);
    if (l->models < models_known) {
        memcpy(l->content[l->models], out, sha256_text_size);
        l->model[l->models++] = model;
    }
    pthread_mutex_unlock(&l->lock);
    return STATUS_OK;
}

static Status name_of(char out[sha256_text_size], SignatureLibrary *l, const SignatureKey *key)
{
    const SignatureLook *look = &key->look;
    char                 content[sha256_text_size];
    const Status         status = content_of(content, l, key->model);
    if (status != STATUS_OK) return status;
    Sha256 *d = sha256_begin();
    bool    ok = d && add_text(d, l->settings) && add_text(d, content) && add_int(d, key->damage) &&
              add_int(d, look->image[0]) && add_int(d, look->image[1]) && add_double(d, look->plane.height_m) &&
              sha256_add(d, look->plane.n, sizeof look->plane.n) && add_double(d, look->tx.range_m) &&
              add_double(d, look->rx.range_m) && sha256_add(d, look->tx.u, sizeof look->tx.u) &&
              sha256_add(d, look->rx.u, sizeof look->rx.u);
    for (int n = 0; n < key->model->node_count && ok; n++) ok = add_double(d, key->joint[n] == 0 ? 0 : key->joint[n]);
    return sha256_end(out, d, ok);
}

/* ---- files ------------------------------------------------------------------------------------------ */

static void refused(SignatureLibrary *l, const char *path)
{
    pthread_mutex_lock(&l->lock);
    l->counters.refused++;
    const bool tell = !l->told;
    l->told = true;
    pthread_mutex_unlock(&l->lock);
    if (tell) log_warn("radar: %s is damaged; its signature is computed again and the file replaced", path);
}

/* Reads the whole file. NULL: it is absent, or no signature has its length. */
static uint8_t *read_whole(size_t *count, const char *path)
{
    static const uint64_t most = head_octets + hash_octets + (uint64_t)most_centres * sizeof(SignatureCentre);
    char                  why[file_why_size];
    uint64_t              there = 0;
    const int             file = file_open(why, &there, path, FILE_FROM_DISK);
    if (file < 0) return NULL;
    uint8_t   *octets = there <= most ? malloc((size_t)there + 1) : NULL;
    const long got = octets ? file_read(file, octets, (size_t)there) : 0;
    *count = got > 0 ? (size_t)got : 0;
    close(file);
    return octets;
}

static bool path_of(char path[4096], const SignatureLibrary *l, const char name[sha256_text_size])
{
    return snprintf(path, 4096, "%s/%s.sig", l->folder, name) < 4096;
}

static CacheKey cache_key_of(const char name[sha256_text_size])
{
    CacheKey key = cache_key("signature");
    cache_key_add(&key, name, hash_octets);
    return key;
}

static uint8_t *read_entry(size_t *count, Cache *cache, const char name[sha256_text_size])
{
    CacheKey key = cache_key_of(name);
    void    *octets;
    return cache_fetch(&octets, count, cache, &key) ? octets : NULL;
}

/* *out: count, centres and tubes' fields of the file. False: it is not there, or, as is said, damaged. */
static bool read_file(Signature *out, SignatureLibrary *l, const SignatureKey *key)
{
    char   name[sha256_text_size], path[4096] = "an entry of the cache";
    size_t count = 0;
    if (name_of(name, l, key) != STATUS_OK || (!l->cache && !path_of(path, l, name))) return false;
    uint8_t *octets = l->cache ? read_entry(&count, l->cache, name) : read_whole(&count, path);
    if (!octets) return false;
    const Status status = signature_from_octets(out, octets, count, name, key->model->part_count);
    free(octets);
    if (status == STATUS_BAD_VALUE) refused(l, path);
    return status == STATUS_OK;
}

static bool fetch(void *user, Signature *out, const SignatureKey *key)
{
    SignatureLibrary       *l = user;
    const SignaturesConfig *c = &l->config;
    const SignatureCells    cells =
        signature_default_cells(c->frequency_hz, c->bandwidth_hz, c->aspect_rad, c->interval_s);
    Signature read = {.tx = key->look.tx, .rx = key->look.rx};
    if (!read_file(&read, l, key)) return false;
    signature_axes(&read, &cells);
    *out = read;
    return true;
}

static bool write_whole(const char *path, const uint8_t *octets, size_t count)
{
    char part[4200];
    snprintf(part, sizeof part, "%s.%ld.part", path, (long)getpid());
    FILE *file = output_file(part, 0);
    if (!file) return false;
    const bool whole = fwrite(octets, 1, count, file) == count;
    if (fclose(file) == 0 && whole && output_rename(part, path) == 0) return true;
    const int why = errno;
    output_remove(part);
    errno = why;
    return false;
}

/* The cache says itself what it cannot write. */
static void write_entry(Cache *cache, const char name[sha256_text_size], const uint8_t *octets, size_t count)
{
    CacheKey key = cache_key_of(name);
    void    *there;
    size_t   size;
    if (cache_fetch(&there, &size, NULL, &key)) free(there); /* ends the key: a NULL cache has nothing */
    cache_keep(cache, &key, octets, count);
}

static void keep(void *user, const Signature *signature, const SignatureKey *key)
{
    SignatureLibrary *l = user;
    char              name[sha256_text_size], path[4096];
    if (name_of(name, l, key) != STATUS_OK || (!l->cache && !path_of(path, l, name))) return;
    const size_t count = signature_to_octets(NULL, signature, name);
    uint8_t     *octets = malloc(count);
    const bool   made = octets && signature_to_octets(octets, signature, name) == count;
    if (l->cache) {
        if (made) write_entry(l->cache, name, octets, count);
        free(octets);
        return;
    }
    const bool written = made && write_whole(path, octets, count);
    const int  why = errno;
    free(octets);
    pthread_mutex_lock(&l->lock);
    const bool first = l->counters.failed == 0;
    l->counters.failed += !written;
    l->counters.written += written;
    l->counters.octets += written ? count : 0;
    pthread_mutex_unlock(&l->lock);
    if (!written && first)
        log_warn("radar: cannot write %s: %s; signatures are made, and not kept in radar.library", path,
                 made ? output_reason(why) : "out of memory");
}

bool signature_library_has(SignatureLibrary *l, const SignatureKey *key)
{
    Signature  read = {0};
    const bool has = read_file(&read, l, key);
    signature_free(&read);
    return has;
}

/* ---- the interface ---------------------------------------------------------------------------------- */

Status signature_library_of_cache(SignatureLibrary **out, Cache *cache, const SignaturesConfig *config,
                                  const RadarMaterials *materials)
{
    SignatureLibrary *l = calloc(1, sizeof *l);
    if (!l) return STATUS_NO_MEMORY;
    l->cache = cache;
    l->config = *config;
    pthread_mutex_init(&l->lock, NULL);
    const Status status = hash_settings(l->settings, config, materials);
    if (status == STATUS_OK) *out = l;
    else signature_library_close(l);
    return status;
}

Status signature_library_open(SignatureLibrary **out, const char *folder, const SignaturesConfig *config,
                              const RadarMaterials *materials)
{
    struct stat about;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        log_error("radar: cannot make the library's folder %s: %s; the folder above it must exist and be writable",
                  folder, strerror(errno));
        return STATUS_IO;
    }
    if (stat(folder, &about) != 0 || !S_ISDIR(about.st_mode)) {
        log_error("radar: %s is no folder; give a library of signatures one of its own", folder);
        return STATUS_IO;
    }
    SignatureLibrary *l = calloc(1, sizeof *l);
    if (!l) return STATUS_NO_MEMORY;
    l->config = *config;
    pthread_mutex_init(&l->lock, NULL);
    Status status = hash_settings(l->settings, config, materials);
    if (snprintf(l->folder, sizeof l->folder, "%s", folder) >= (int)sizeof l->folder) {
        log_error("radar: the library's path is longer than %zu octets; give a shorter one", sizeof l->folder - 1);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) *out = l;
    else signature_library_close(l);
    return status;
}

void signature_library_close(SignatureLibrary *l)
{
    if (!l) return;
    pthread_mutex_destroy(&l->lock);
    free(l);
}

SignatureStore signature_library_store(SignatureLibrary *l)
{
    return (SignatureStore){.user = l, .fetch = fetch, .keep = keep};
}

SignatureLibraryCounters signature_library_counters(SignatureLibrary *l)
{
    pthread_mutex_lock(&l->lock);
    const SignatureLibraryCounters c = l->counters;
    pthread_mutex_unlock(&l->lock);
    return c;
}
