/* A complete test article, built for a version of the interface that is still to come. */
#define vbar_gnc_abi_version version_of_the_article_below
#include "article_without_step.c" /* NOLINT: the rest of it */
#undef vbar_gnc_abi_version

int32_t vbar_gnc_abi_version(void);
int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION + 1;
}

vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  (void)state;
  (void)gps_time_ns;
  return 0;
}
