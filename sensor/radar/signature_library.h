/* sensor/radar/signature_library.h: signatures of targets on disk, by content hash.
 *
 * A signature's file is FOLDER/HASH.sig, HASH the SHA-256 of all that its bits follow from: the model's geometry,
 * parts and joints, damage, pose, bin, ground, materials, frequency, band, settings of the ray tubes, unevenness, and
 * the version of the computation. What does not fit has another name, so a folder serves any exercise and preset, and
 * a file is never wrong for being old. Files are written whole (beside their name, and renamed), so that several
 * programs may share a folder. Little-endian, as all that this program runs on:
 *
 *     octets   0  "PVSIGN1\n"        8  HASH, 64 hexadecimal digits     72  centres, 32 bits     76  0, 32 bits
 *             80  centres (SignatureCentre), 84 octets each
 *            end  SHA-256 of all of the above, 64 hexadecimal digits
 *
 * A file that is damaged, of another name's content, or out of range is reported once, counted, and made anew.
 *
 * Without a folder, what would be a file of it is an entry of the cache between runs. */
#ifndef SENSOR_RADAR_SIGNATURE_LIBRARY_H
#define SENSOR_RADAR_SIGNATURE_LIBRARY_H

#include "render/scattering/signatures/signatures.h"
#include "pitviper_cache.h"
#include "pitviper_sha256.h"

typedef struct SignatureLibrary SignatureLibrary;

/* Opens a folder, which is made if it is not there. config: its band, bins, tubes and unevenness count; materials:
 * those in use. Failures are logged. */
Status signature_library_open(SignatureLibrary **out, const char *folder, const SignaturesConfig *config,
                              const RadarMaterials *materials);
/* The same in a cache, which must outlive it. */
Status signature_library_of_cache(SignatureLibrary **out, Cache *cache, const SignaturesConfig *config,
                                  const RadarMaterials *materials);
void   signature_library_close(SignatureLibrary *library); /* accepts NULL */
/* For signatures_create; valid until the library is closed. */
SignatureStore signature_library_store(SignatureLibrary *library);
/* Whether it has its file, and that is whole: it is read. */
bool signature_library_has(SignatureLibrary *library, const SignatureKey *key);
/* Octets written; files that were refused. */
typedef struct SignatureLibraryCounters {
    uint64_t octets, written, refused, failed;
} SignatureLibraryCounters;
SignatureLibraryCounters signature_library_counters(SignatureLibrary *library);

/* Reads the octets of a file into count and centre of out. parts: how many the model has. STATUS_BAD_VALUE: anything is
 * wrong. */
Status signature_from_octets(Signature *out, const uint8_t *octets, size_t count, const char key[sha256_text_size],
                             int parts);
/* Its length, and the octets where out is not NULL. */
size_t signature_to_octets(uint8_t *out, const Signature *signature, const char key[sha256_text_size]);

#endif
