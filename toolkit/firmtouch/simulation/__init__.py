"""Plant + gains -> trajectory: the nonlinear closed loop under the paper's controllers."""
