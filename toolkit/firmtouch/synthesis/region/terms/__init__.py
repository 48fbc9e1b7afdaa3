"""What may be asked of a design, one term a file; each adds its constraints to one problem and audits the gains."""
