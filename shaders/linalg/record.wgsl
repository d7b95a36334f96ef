// What the host reads of a slot's linear solve, and what its kernels go by.
struct Record {
    done: u32,
    vectors: u32,           // of the Krylov basis, those that are complete
    steps: u32,             // of the present cycle
    iterations: u32,        // in all
    relative_to_start: u32, // the tolerance is of the first residual, not of the right-hand side
    tolerance: real,
    goal: real,             // norm of the residual to be reached
    rhs_norm: real,         // of the right-hand side, what is fixed taken over
    start_norm: real,       // of the residual at the guess
    residual: real,         // norm of the residual, by the recurrence
    scale: real,            // of the next basis vector
    along: real,            // plate force along the solution
    running: u32,           // of the slots in a list, those that run first: which one is here
}

const RUNNING: u32 = 0u;
const CONVERGED: u32 = 1u;
const FULL: u32 = 2u;       // no room for another vector
const STALLED: u32 = 3u;    // no new direction
const NOT_FINITE: u32 = 4u;
