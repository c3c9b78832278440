/* pitviper_sha256.c: SHA-256 as text, by OpenSSL. */
#include "pitviper_sha256.h"

#include "pitviper_file.h"

#include <errno.h>
#include <openssl/evp.h>
#include <unistd.h>

static void to_text(char out[sha256_text_size], const unsigned char digest[32])
{
    static const char digit[] = "0123456789abcdef";
    for (int i = 0; i < 32; i++) {
        out[2 * i] = digit[digest[i] >> 4];
        out[2 * i + 1] = digit[digest[i] & 15];
    }
    out[64] = '\0';
}

Status sha256_end(char out[sha256_text_size], Sha256 *digest, bool ok)
{
    unsigned char sum[EVP_MAX_MD_SIZE];
    unsigned int  octets = 0;
    ok = ok && EVP_DigestFinal_ex(digest, sum, &octets) == 1 && octets == 32;
    EVP_MD_CTX_free(digest);
    if (!ok) return STATUS_NO_MEMORY;
    to_text(out, sum);
    return STATUS_OK;
}

Sha256 *sha256_begin(void)
{
    EVP_MD_CTX *digest = EVP_MD_CTX_new();
    if (digest && EVP_DigestInit_ex(digest, EVP_sha256(), NULL) == 1) return digest;
    EVP_MD_CTX_free(digest);
    return NULL;
}

bool sha256_add(Sha256 *digest, const void *bytes, size_t count) { return EVP_DigestUpdate(digest, bytes, count) == 1; }

Status sha256_bytes(char out[sha256_text_size], const void *bytes, size_t count)
{
    Sha256 *digest = sha256_begin();
    if (!digest) return STATUS_NO_MEMORY;
    return sha256_end(out, digest, count == 0 || sha256_add(digest, bytes, count));
}

Status sha256_file(char out[sha256_text_size], const char *path)
{
    char      why[file_why_size];
    const int file = file_open(why, NULL, path, FILE_FROM_DISK);
    if (file < 0) {
        log_error("hash: cannot read %s: %s", path, why);
        return STATUS_IO;
    }
    Sha256 *digest = sha256_begin();
    bool    ok = digest;
    char    chunk[65536];
    long    n = 1;
    while (ok && (n = file_read(file, chunk, sizeof chunk)) > 0) ok = sha256_add(digest, chunk, (size_t)n);
    const int reason = n < 0 ? errno : 0;
    close(file);
    if (reason) {
        log_error("hash: cannot read %s: %s", path, strerror(reason));
        EVP_MD_CTX_free(digest);
        return STATUS_IO;
    }
    return digest ? sha256_end(out, digest, ok) : STATUS_NO_MEMORY;
}
