// A PPS device where there is none: the ioctls of RFC 2783 on Linux, answered for /dev/null. Linked into a test, or
// loaded into ppstest with LD_PRELOAD.
//   VBAR_PPS_PERIOD_MS   between edges, which are multiples of it on CLOCK_REALTIME (1000)
//   VBAR_PPS_NO_WAIT     the device cannot wait for an edge
//   VBAR_PPS_NO_ASSERT   the device captures clear edges only
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/timepps.h>
#include <time.h>

typedef long long ns_t;
static const ns_t kSecond = 1000000000;
static int mode = PPS_TSFMT_TSPEC;

static ns_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

static ns_t period_ns(void) {
  const char* text = getenv("VBAR_PPS_PERIOD_MS");
  return (text ? atoll(text) : 1000) * 1000000;
}

static void sleep_ns(ns_t ns) {
  const struct timespec pause = {ns / kSecond, ns % kSecond};
  nanosleep(&pause, NULL);
}

static int fetch(struct pps_fdata* data) {
  const ns_t begin = now_ns(), period = period_ns();
  const int forever = (data->timeout.flags & PPS_TIME_INVALID) != 0;
  const ns_t timeout = data->timeout.sec * kSecond + data->timeout.nsec;
  if (forever || timeout > 0) {
    const ns_t next = (begin / period + 1) * period;
    if (!forever && next - begin > timeout) {
      sleep_ns(timeout);
      errno = ETIMEDOUT;
      return -1;
    }
    sleep_ns(next - begin);
  }
  const ns_t edge = now_ns() / period * period;
  memset(&data->info, 0, sizeof data->info);
  data->info.assert_sequence = (unsigned)(edge / period);
  data->info.assert_tu.sec = edge / kSecond;
  data->info.assert_tu.nsec = (int)(edge % kSecond);
  data->info.current_mode = mode;
  return 0;
}

static int answer(unsigned long request, void* argument) {
  struct pps_kparams* parameters = argument;
  const int edges = getenv("VBAR_PPS_NO_ASSERT") ? PPS_CAPTURECLEAR : PPS_CAPTUREASSERT;
  switch (request) {
    case PPS_GETPARAMS:
      memset(parameters, 0, sizeof *parameters);
      parameters->api_version = PPS_API_VERS_1;
      parameters->mode = mode;
      return 0;
    case PPS_SETPARAMS:
      mode = parameters->mode;
      return 0;
    case PPS_GETCAP:
      *(int*)argument = edges | PPS_TSFMT_TSPEC | (getenv("VBAR_PPS_NO_WAIT") ? 0 : PPS_CANWAIT);
      return 0;
    case PPS_FETCH:
      return fetch(argument);
    default:
      errno = ENOTTY;
      return -1;
  }
}

int ioctl(int fd, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  struct stat file;
  const int is_null = fstat(fd, &file) == 0 && S_ISCHR(file.st_mode) && file.st_rdev == makedev(1, 3);
  if (is_null && ((request >> 8) & 0xff) == 'p') return answer(request, argument);
  int (*next)(int, unsigned long, ...) = (int (*)(int, unsigned long, ...))dlsym(RTLD_NEXT, "ioctl");
  return next(fd, request, argument);
}
