"""What a study is made of: batches of runs, histories, rows, reports."""
