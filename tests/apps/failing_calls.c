/* Preloaded by tests: the n-th call of a kind that touches files below a folder fails.
 *   FAIL_CALL=write|rename|fsync|open|link|ftruncate|posix_fallocate  FAIL_AT=n (from 1)
 *   FAIL_CALL=pthread_create|fork: anywhere, FAIL_ERRNO=11 (EAGAIN)
 *   FAIL_UNDER=folder  FAIL_ERRNO=28 (default: ENOSPC)  FAIL_AFTER=1: all later ones too
 *   FAIL_KILL=1: the process is killed there instead, before the call */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static int calls = 0;

static int below(const char* path) {
  const char* folder = getenv("FAIL_UNDER");
  return folder != NULL && path != NULL && strncmp(path, folder, strlen(folder)) == 0;
}

static int descriptor_below(int descriptor) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = '\0';
  return below(path);
}

static int fails(const char* call, int touches) {
  const char* which = getenv("FAIL_CALL");
  if (!touches || which == NULL || strcmp(which, call) != 0) return 0;
  const int at = atoi(getenv("FAIL_AT")), now = __sync_add_and_fetch(&calls, 1);
  if (now != at && !(now > at && getenv("FAIL_AFTER") != NULL)) return 0;
  if (getenv("FAIL_KILL") != NULL) kill(getpid(), SIGKILL);
  errno = getenv("FAIL_ERRNO") != NULL ? atoi(getenv("FAIL_ERRNO")) : ENOSPC;
  return 1;
}

#define REAL(type, name, ...) ((type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name))

ssize_t write(int descriptor, const void* bytes, size_t size) {
  if (fails("write", descriptor_below(descriptor))) return -1;
  return REAL(ssize_t, "write", int, const void*, size_t)(descriptor, bytes, size);
}

int fsync(int descriptor) {
  if (fails("fsync", descriptor_below(descriptor))) return -1;
  return REAL(int, "fsync", int)(descriptor);
}

int ftruncate(int descriptor, off_t size) {
  if (fails("ftruncate", descriptor_below(descriptor))) return -1;
  return REAL(int, "ftruncate", int, off_t)(descriptor, size);
}

int posix_fallocate(int descriptor, off_t from, off_t size) {
  if (fails("posix_fallocate", descriptor_below(descriptor))) return errno;
  return REAL(int, "posix_fallocate", int, off_t, off_t)(descriptor, from, size);
}

int rename(const char* from, const char* to) {
  if (fails("rename", below(to))) return -1;
  return REAL(int, "rename", const char*, const char*)(from, to);
}

int link(const char* from, const char* to) {
  if (fails("link", below(to))) return -1;
  return REAL(int, "link", const char*, const char*)(from, to);
}

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & O_CREAT ? (mode_t)va_arg(more, int) : 0;
  va_end(more);
  if (fails("open", (flags & O_CREAT) && below(path))) return -1;
  return REAL(int, "open", const char*, int, mode_t)(path, flags, mode);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* how, void* (*start)(void*), void* argument) {
  if (fails("pthread_create", 1)) return errno;
  return REAL(int, "pthread_create", pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)(thread, how, start,
                                                                                            argument);
}

pid_t fork(void) {
  if (fails("fork", 1)) return -1;
  return REAL(pid_t, "fork", void)();
}
