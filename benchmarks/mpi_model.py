"""What a step costs on many ranks: the model of include/tactoid/mpi/README.md, as a table.

    python3 mpi_model.py [--sum-order ranks --ns-per-pair 8 --latency 6e-6 --bandwidth 2e9 --surface 0]

A cube of N particles, cut into P cubes of n = N/P; a rank computes alone, one thread. Times in seconds, bytes as doubles of 8. Sums are made in the
order of the ranks (SumOrder::of_ranks), or with --sum-order process in that of one process.
"""

import argparse
import math

ROW = 57  # pairs of a row at the support 2.35: particles within two layers and a bit
REACH = 2.02  # layers of particles that a row reaches beyond its point: from the measured halo of the block of 54³
CHUNK = 2048  # points of large bodies
UNPACK = 30e-9  # s per chunk of the whole body, on every rank
LOOK = 3e-9  # s per particle of a surface, on every rank


def step(N, P, by_rank, c, latency, bandwidth, surface, contact):
    n = N / P
    a = n ** (1 / 3)
    whole = N ** (1 / 3)
    grown = min(a + 2 * REACH, whole) ** 3  # particles that own rows touch; as rows, those that touch own particles
    if by_rank:
        work = c * ROW * n
        tell = (48 + 24) * (grown - n) / bandwidth  # motion there, forces back
        sums = P * 80 / bandwidth
    else:
        work = c * ROW * grown
        tell = 48 * (min(a + 4 * REACH, whole) ** 3 - n) / bandwidth
        chunks = N / CHUNK * (56 / bandwidth + UNPACK)  # all chunks to all ranks
        sums = chunks + 8 * max(n, N / min(P, 64)) / bandwidth  # kinetic energy: 64 parts are summed by 64 ranks at most
    known = surface * 6 * whole**2
    if by_rank:  # contacts are divided, but that each rank looks how far the surfaces have moved
        contacts = known * (72 / bandwidth + LOOK + contact / P)
        calls = 9 if known > 0 else 4  # what is known to all, whether to search, forces (two), energies
    else:  # four fifths of a contact's time follow closest points, which is divided; 88 bytes for each point go to all ranks
        contacts = known * ((72 + 88) / bandwidth + contact * (0.2 + 0.8 / P))
        calls = 6 if known > 0 else 4  # what is known to all, and closest points
    wait = calls * latency * math.log2(P)
    return c * ROW * N / P, work, tell, sums, contacts, wait


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sum-order", choices=("ranks", "process"), default="ranks", help="in which sums are made")
    parser.add_argument("--ns-per-pair", type=float, default=8.0)
    parser.add_argument("--latency", type=float, default=6e-6, help="s per stage of a collective call")
    parser.add_argument("--bandwidth", type=float, default=2e9, help="bytes/s that one rank sends or receives")
    parser.add_argument("--surface", type=float, default=0.0, help="share of the cube's surface that is known to all")
    parser.add_argument("--contact-ns", type=float, default=200.0, help="ns per particle of that surface in one process")
    p = parser.parse_args()
    print("| N | ranks | particles per rank | rows evaluated twice | step, ms | halo | sums | surfaces | waiting | efficiency |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for N in (1e7, 1e8, 1e9):
        for P in (64, 256, 1024, 4096):
            ideal, work, *rest = step(N, P, p.sum_order == "ranks", 1e-9 * p.ns_per_pair, p.latency, p.bandwidth, p.surface, 1e-9 * p.contact_ns)
            total = work + sum(rest)
            shares = " | ".join(f"{100 * x / total:.1f} %" for x in rest)
            print(f"| 10{'⁷⁸⁹'[int(round(math.log10(N))) - 7]} | {P} | {N / P:.3g} | {100 * (work / ideal - 1):.0f} % | {1e3 * total:.3g} | {shares} | {ideal / total:.2f} |")


if __name__ == "__main__":
    main()
