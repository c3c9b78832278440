/* pitviper_sha256.h: SHA-256 as 64 hexadecimal digits. */
#ifndef PITVIPER_SHA256_H
#define PITVIPER_SHA256_H

#include "pitviper.h"

enum { sha256_text_size = 65 };

Status sha256_bytes(char out[sha256_text_size], const void *bytes, size_t count);
/* Hashes the bytes of a file. Logs path and reason on failure. */
Status sha256_file(char out[sha256_text_size], const char *path);

/* In pieces. Begin gives NULL, add false when memory is out. */
typedef struct evp_md_ctx_st Sha256;
Sha256                      *sha256_begin(void);
bool                         sha256_add(Sha256 *digest, const void *bytes, size_t count);
/* Frees the digest. ok: whether all was added; STATUS_NO_MEMORY and out untouched otherwise. */
Status sha256_end(char out[sha256_text_size], Sha256 *digest, bool ok);

#endif
