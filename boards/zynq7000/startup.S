/* From reset, a debugger's `go` or a boot loader to main(), and the exception vectors.
 *
 * Nothing is assumed of what ran before: caches and the MMU may be on (U-Boot leaves them so, with this image perhaps
 * still in dirty cache lines) or in their random state after reset. References: ARM Architecture Reference Manual
 * ARMv7-A (DDI 0406), Cortex-A9 TRM (DDI 0388), UG585 chapter 3. */
    .syntax unified
    .cpu cortex-a9
    .fpu neon
    .arm

    .equ MODE_FIQ, 0x11
    .equ MODE_IRQ, 0x12
    .equ MODE_SVC, 0x13
    .equ MODE_ABT, 0x17
    .equ MODE_UND, 0x1b
    .equ MODE_SYS, 0x1f

    .equ SCTLR_M, 1 << 0            /* MMU */
    .equ SCTLR_A, 1 << 1            /* alignment faults */
    .equ SCTLR_C, 1 << 2            /* data cache */
    .equ SCTLR_Z, 1 << 11           /* branch prediction */
    .equ SCTLR_I, 1 << 12           /* instruction cache */
    .equ SCTLR_V, 1 << 13           /* vectors at 0xffff0000 instead of VBAR */
    .equ SCTLR_TE, 1 << 30          /* exceptions in Thumb state */

    .equ STACK_PAINT, 0xdeadbeef    /* kStackPaint of stack_meter.cpp */

/* ------------------------------------------------------------------------------------- vectors */
    .section .vectors, "ax"
    .align 5
    .global vbar_vectors
vbar_vectors:
    ldr pc, =vbar_start
    ldr pc, =undefined_entry
    ldr pc, =supervisor_entry
    ldr pc, =prefetch_abort_entry
    ldr pc, =data_abort_entry
    nop
    ldr pc, =interrupt_entry
    ldr pc, =fast_interrupt_entry
    .ltorg

/* ------------------------------------------------------------------------------------- start-up */
    .section .text.startup, "ax"
    .global vbar_start
    .type vbar_start, %function
vbar_start:
    cpsid aif, #MODE_SVC

    mrc p15, 0, r0, c0, c0, 5       /* MPIDR: only the first core flies */
    ands r0, r0, #3
    beq first_core
park_core:
    wfe
    b park_core

first_core:
    /* Caches off. Data that an earlier program left in them is written back first: this image may be among it. */
    mrc p15, 0, r4, c1, c0, 0       /* SCTLR */
    ldr r1, =(SCTLR_C | SCTLR_I)
    bic r0, r4, r1
    mcr p15, 0, r0, c1, c0, 0
    isb
    tst r4, #SCTLR_C
    beq level1_unknown
    bl clean_level1_data_cache
    bl clean_level2_cache
    b caches_clean
level1_unknown:
    bl invalidate_level1_data_cache
caches_clean:
    ldr r1, =(SCTLR_M | SCTLR_A | SCTLR_C | SCTLR_I | SCTLR_Z | SCTLR_V | SCTLR_TE)
    bic r0, r4, r1
    mcr p15, 0, r0, c1, c0, 0
    isb
    mov r0, #0
    mcr p15, 0, r0, c8, c7, 0       /* TLBIALL */
    mcr p15, 0, r0, c7, c5, 0       /* ICIALLU */
    mcr p15, 0, r0, c7, c5, 6       /* BPIALL */
    dsb
    isb

    ldr r0, =vbar_vectors
    mcr p15, 0, r0, c12, c0, 0      /* VBAR */

    cps #MODE_FIQ
    ldr sp, =__fast_interrupt_stack_top
    cps #MODE_ABT
    ldr sp, =__abort_stack_top
    cps #MODE_UND
    ldr sp, =__undefined_stack_top
    cps #MODE_SVC
    ldr sp, =__supervisor_stack_top
    cps #MODE_SYS                   /* flight code and interrupt handlers; IRQ mode's own stack is never used */
    ldr sp, =__stack_top

    /* VFP and NEON for everybody. FPSCR = 0: round to nearest, subnormals kept, NaNs propagated, as on the host. */
    mrc p15, 0, r0, c1, c0, 2       /* CPACR */
    orr r0, r0, #(0xf << 20)
    bic r0, r0, #(3 << 30)
    mcr p15, 0, r0, c1, c0, 2
    isb
    mov r0, #0x40000000
    vmsr fpexc, r0
    mov r0, #0
    vmsr fpscr, r0

    bl vbar_memory_enable           /* mmu.cpp; needs no .bss */

    ldr r0, =__bss_start
    ldr r1, =__bss_end
    mov r2, #0
    mov r3, #0
clear_bss:
    cmp r0, r1
    strdlo r2, r3, [r0], #8
    blo clear_bss

    ldr r0, =__stack_bottom
    ldr r2, =STACK_PAINT
paint_stack:
    cmp r0, sp
    strlo r2, [r0], #4
    blo paint_stack

    bl vbar_construct_statics       /* runtime.cpp */
    bl main
    b vbar_main_returned

/* ------------------------------------------------------------------------------------- cache maintenance
 * Level 1 data cache by set and way: 4 ways of 32-byte lines, as many sets as CCSIDR says. No stack, no memory. */
    .macro level1_by_set_and_way operation
    mov r0, #0
    mcr p15, 2, r0, c0, c0, 0       /* CSSELR: level 1 data */
    isb
    mrc p15, 1, r0, c0, c0, 0       /* CCSIDR */
    ubfx r1, r0, #13, #15           /* sets - 1 */
    mov r2, #3                      /* ways - 1 */
1:  mov r3, r1
2:  lsl r12, r2, #30
    orr r12, r12, r3, lsl #5
    mcr p15, 0, r12, c7, \operation, 2
    subs r3, r3, #1
    bpl 2b
    subs r2, r2, #1
    bpl 1b
    dsb
    bx lr
    .endm

invalidate_level1_data_cache:       /* DCISW */
    level1_by_set_and_way c6
clean_level1_data_cache:            /* DCCISW */
    level1_by_set_and_way c14

/* Level 2 (PL310): writes everything back and switches it off. */
clean_level2_cache:
    ldr r0, =0xf8f02000
    ldr r1, [r0, #0x100]            /* control */
    tst r1, #1
    bxeq lr
    ldr r1, =0xff
    str r1, [r0, #0x7fc]            /* clean and invalidate by way */
1:  ldr r2, [r0, #0x7fc]
    tst r2, r1
    bne 1b
    mov r1, #0
    str r1, [r0, #0x730]            /* drain */
    dsb
    str r1, [r0, #0x100]
    dsb
    bx lr
    .ltorg

/* ------------------------------------------------------------------------------------- exceptions
 * vbar_fault(kind, return address, status register, {stack pointer, link register} of the interrupted code). */
    .macro fault name, kind
\name:
    sub sp, sp, #8
    stm sp, {sp, lr}^               /* those of system mode */
    nop
    mov r0, #\kind
    mov r1, lr
    mrs r2, spsr
    mov r3, sp
    bl vbar_fault
    b .
    .endm

    fault undefined_entry, 1
    fault prefetch_abort_entry, 2
    fault data_abort_entry, 3
    fault fast_interrupt_entry, 4

/* The only SVC is a semihosting request (semihosting.cpp). It arrives here where nobody listens: on silicon without a
 * debugger. Answer "not done" and go on; never stop the processor. */
supervisor_entry:
    mvn r0, #0
    movs pc, lr

/* Interrupts run in system mode on the stack of the code they interrupt and keep all of its floating-point registers
 * that a called function may use. */
interrupt_entry:
    sub lr, lr, #4
    srsdb sp!, #MODE_SYS
    cps #MODE_SYS
    push {r0-r3, r12, lr}
    and r1, sp, #4                  /* a called function expects 8-byte alignment */
    sub sp, sp, r1
    push {r1, r2}
    vpush {d0-d7}
    vpush {d16-d31}
    vmrs r0, fpscr
    push {r0, r1}
    bl vbar_interrupt
    pop {r0, r1}
    vmsr fpscr, r0
    vpop {d16-d31}
    vpop {d0-d7}
    pop {r1, r2}
    add sp, sp, r1
    pop {r0-r3, r12, lr}
    rfeia sp!
    .ltorg
