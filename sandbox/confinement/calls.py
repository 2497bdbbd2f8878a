"""The system calls of a program that only computes, with their numbers.

From the kernel's tables: unistd_64.h of x86, and asm-generic/unistd.h, which 64-bit Arm has.
"""

from __future__ import annotations

from typing import Final

X86_64, AARCH64 = 0, 1

_NUMBERS: Final = """
    read 0 63 · readv 19 65 · pread64 17 67 · lseek 8 62 · close 3 57 · dup2 33 - · dup3 292 24
    stat 4 - · lstat 6 - · fstat 5 80 · newfstatat 262 79 · statx 332 291 · getcwd 79 17
    readlink 89 - · readlinkat 267 78 · access 21 - · faccessat 269 48
    open 2 - · openat 257 56 · fcntl 72 25 · ioctl 16 29
    write 1 64 · writev 20 66 · poll 7 - · ppoll 271 73
    mmap 9 222 · mprotect 10 226 · munmap 11 215 · mremap 25 216 · madvise 28 233 · brk 12 214
    fork 57 - · vfork 58 - · clone 56 220 · execve 59 221
    futex 202 98 · set_robust_list 273 99 · rseq 334 293 · set_tid_address 218 96 · gettid 186 178
    membarrier 324 283 · sched_yield 24 124 · sched_getaffinity 204 123 · getcpu 309 168
    nanosleep 35 101 · clock_nanosleep 230 115 · restart_syscall 219 128
    exit 60 93 · exit_group 231 94 · arch_prctl 158 - · prctl 157 167
    rt_sigaction 13 134 · rt_sigprocmask 14 135 · rt_sigreturn 15 139 · sigaltstack 131 132
    clock_gettime 228 113 · clock_getres 229 114 · gettimeofday 96 169 · time 201 -
    getrandom 318 278 · uname 63 160 · sysinfo 99 179 · getrusage 98 165 · get_mempolicy 239 236
    getpid 39 172 · getppid 110 173 · getuid 102 174 · geteuid 107 175 · getgid 104 176
    getegid 108 177 · getrlimit 97 163 · prlimit64 302 261
    pipe2 293 59 · epoll_ctl 233 21 · epoll_wait 232 - · epoll_pwait 281 22 · pidfd_open 434 434
    wait4 61 260 · waitid 247 95
"""
"""The last two lines are for the thread that starts the interpreter and then ends."""

NUMBERS: Final[dict[str, tuple[int | None, int | None]]] = {
    name: (None if x86 == "-" else int(x86), None if arm == "-" else int(arm))
    for name, x86, arm in (
        each.split() for line in _NUMBERS.strip().splitlines() for each in line.split("·")
    )
}

ASKED: Final = ("fork", "vfork", "execve")
"""To start a process or a program; `clone` does that too, or it starts a thread."""
