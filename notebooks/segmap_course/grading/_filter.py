"""A filter for bubblewrap: the system calls that no answer needs end in an error.

A program of the kernel's own small language (BPF, seccomp(2)): it looks at the number of a call.
"""

from __future__ import annotations

import errno
import platform
import struct

#: Machine -> its name in the kernel (audit.h), and the column of its numbers in `KEPT_OUT`.
MACHINES = {"x86_64": (0xC000003E, 0), "aarch64": (0xC00000B7, 1)}
#: Call -> its numbers on x86_64 and aarch64 (asm/unistd.h).
KEPT_OUT = {
    # Other processes: the first one of the jail has no limit of processes, and must not be led
    "ptrace": (101, 117),
    "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271),
    "pidfd_send_signal": (424, 424),
    "pidfd_open": (434, 434),
    "pidfd_getfd": (438, 438),
    "kcmp": (312, 272),
    # Memory that no limit counts: files without a folder, shared pieces, what waits in a socket
    "memfd_create": (319, 279),
    "memfd_secret": (447, 447),
    "shmget": (29, 194),
    "msgget": (68, 186),
    "semget": (64, 190),
    "mq_open": (240, 180),
    "socket": (41, 198),
    "socketpair": (53, 199),
    # Keyrings
    "add_key": (248, 217),
    "request_key": (249, 218),
    "keyctl": (250, 219),
    # Calls that go past this filter, or that are seldom right in the kernel
    "io_uring_setup": (425, 425),
    "io_uring_enter": (426, 426),
    "io_uring_register": (427, 427),
    "bpf": (321, 280),
    "perf_event_open": (298, 241),
    "userfaultfd": (323, 282),
    "personality": (135, 92),
    # Mounts, and files by their number
    "mount": (165, 40),
    "umount2": (166, 39),
    "pivot_root": (155, 41),
    "chroot": (161, 51),
    "open_tree": (428, 428),
    "move_mount": (429, 429),
    "fsopen": (430, 430),
    "fsconfig": (431, 431),
    "fsmount": (432, 432),
    "fspick": (433, 433),
    "mount_setattr": (442, 442),
    "unshare": (272, 97),
    "setns": (308, 268),
    "name_to_handle_at": (303, 264),
    "open_by_handle_at": (304, 265),
    # The machine
    "kexec_load": (246, 104),
    "kexec_file_load": (320, 294),
    "init_module": (175, 105),
    "finit_module": (313, 273),
    "delete_module": (176, 106),
    "reboot": (169, 142),
    "swapon": (167, 224),
    "swapoff": (168, 225),
    "acct": (163, 89),
    "quotactl": (179, 60),
    "syslog": (103, 116),
}
#: The newest call that was looked at: set_mempolicy_home_node, of Linux 5.17. Later ones, and those
#: of 32 bit addresses (x32), are unknown here: whoever asks for one has to do without.
NEWEST = 450
#: Instructions: load a word of what is asked, compare and jump, end.
LOAD, EQUAL, ABOVE, RETURN = 0x20, 0x15, 0x25, 0x06
#: Ends of the program.
ALLOW, FAIL, KILL = 0x7FFF0000, 0x00050000, 0x80000000


def seccomp(machine: str = platform.machine()) -> bytes:
    """The filter for one kind of machine.

    Raises
    ------
    ValueError
        Where its numbers are not known.
    """
    if machine not in MACHINES:
        raise ValueError(f"the numbers of the system calls of {machine} are not known")
    audit, column = MACHINES[machine]
    numbers = sorted(pair[column] for pair in KEPT_OUT.values())
    steps = [
        (LOAD, 0, 0, 4),  # the machine that the call is meant for
        (EQUAL, 1, 0, audit),
        (RETURN, 0, 0, KILL),
        (LOAD, 0, 0, 0),  # the number of the call
        (ABOVE, len(numbers) + 1, 0, NEWEST),
        *((EQUAL, len(numbers) + 1 - k, 0, number) for k, number in enumerate(numbers)),
        (RETURN, 0, 0, ALLOW),
        (RETURN, 0, 0, FAIL | errno.ENOSYS),
        (RETURN, 0, 0, FAIL | errno.EPERM),
    ]
    return b"".join(struct.pack("HBBI", *step) for step in steps)
