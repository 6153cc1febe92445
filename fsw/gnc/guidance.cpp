#include "fsw/gnc/guidance.h"
