/* tests/sensor/signature_files.h: looks at a truck through signatures that a library keeps in a folder. */
#ifndef TESTS_SENSOR_SIGNATURE_FILES_H
#define TESTS_SENSOR_SIGNATURE_FILES_H

#include "tests/check.h"

#include "sensor/radar/signature_library.h"

#include <dirent.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64];

static Catalog *catalog;

static RadarMaterials materials;

static int model;

static Cache *cache; /* not NULL: in place of the folder */

static inline SignaturesConfig config_of(double warp_m)
{
    return (SignaturesConfig){.frequency_hz = 5e9,
                              .bandwidth_hz = 1e8,
                              .aspect_rad = 0.3 * rad_per_deg,
                              .rays_per_wavelength = 0.5,
                              .warp_m = warp_m,
                              .most_octets = 1 << 30,
                              .isa = "avx2"};
}

static inline int open_all(void **state)
{
    static const DisEntityType truck = {1, 1, 225, 7, 1, 0, 0};
    Origin                     origin;
    char                       path[4096];
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/pitviper-library-%d", (int)getpid());
    if (!etc_path(path, sizeof path, "catalog.csv") || catalog_open(&catalog, path, radar_sag_m(5e9)) != STATUS_OK)
        return -1;
    model = catalog_find(catalog, truck, &origin, NULL);
    return radar_materials_load(&materials) == STATUS_OK ? 0 : -1;
}

static inline int empty_folder(bool remove_it)
{
    char           path[400];
    int            files = 0;
    DIR           *d = opendir(folder);
    struct dirent *e;
    while (d && (e = readdir(d))) {
        if (e->d_name[0] == '.') continue;
        files++;
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        if (remove_it) unlink(path);
    }
    if (d) closedir(d);
    if (remove_it) rmdir(folder);
    return files;
}

static inline int close_all(void **state)
{
    (void)state;
    empty_folder(true);
    radar_materials_close(&materials);
    catalog_close(catalog);
    return 0;
}

typedef struct Got {
    int                      count;
    SignatureCentre          centre[200000];
    SignatureCounters        counters;
    SignatureLibraryCounters files;
} Got;

/* One look through a library and signatures of its own. */
static inline void look(Got *out, double az_deg, const double *joint, double warp_m, bool with_library)
{
    SignaturesConfig  config = config_of(warp_m);
    SignatureLibrary *library = NULL;
    Signatures       *s;
    const Signature  *got;
    ScatterAntenna    a;
    radar_look(&a, az_deg * rad_per_deg, 12 * rad_per_deg, 2000);
    const SignatureLook of = signature_look(&a);
    if (with_library) {
        CHECK((cache ? signature_library_of_cache(&library, cache, &config, &materials)
                     : signature_library_open(&library, folder, &config, &materials)) == STATUS_OK);
        config.store = signature_library_store(library);
    }
    CHECK(signatures_create(&s, &config, catalog, &materials) == STATUS_OK);
    CHECK(signatures_find(&got, s, model, joint, 0, &of, NULL) == STATUS_OK);
    CHECK(got->count > 100 && got->count <= 200000);
    out->count = got->count;
    memcpy(out->centre, got->centre, (size_t)got->count * sizeof *got->centre);
    out->counters = signatures_counters(s);
    if (library) out->files = signature_library_counters(library);
    /* axes are made anew: their field, too */
    Centres       centres = {0};
    ScatterMatrix field;
    CHECK(centres_make(&centres, got, &a, &a, NULL) == STATUS_OK);
    centres_field(&field, &centres, 5e9);
    CHECK(cabs(field.vv) > 0);
    centres_free(&centres);
    signatures_destroy(s);
    signature_library_close(library);
}

static inline bool same(const Got *a, const Got *b)
{
    return a->count == b->count && memcmp(a->centre, b->centre, (size_t)a->count * sizeof *a->centre) == 0;
}

#endif
